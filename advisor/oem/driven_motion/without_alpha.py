"""Noise of a motion whose angle of attack is not measured, so that gusts and jolts look alike."""

import numpy as np

from advisor.flight.signals.robust import robust_std
from advisor.oem.driven_motion.setting import Setting
from advisor.oem.turbulence import Rows, Turbulence, find_turbulence

MOST_MANEUVERS = 7
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""


def moving_air(setting: Setting) -> Turbulence:
    """Return the moving air and the noise that fit the residuals of a setting best."""
    rows = [_rows(setting, m) for m in range(len(setting.records))][-MOST_MANEUVERS:]
    outputs = range(len(setting.assembly.names.outputs))
    white = np.array([_white([r.residual[r.channel == c] for r in rows]) for c in outputs])
    return find_turbulence(rows, white, start_variance=0.0)


def _white(parts: list[np.ndarray]) -> float:
    """Return the standard deviation of the white part of an output's residuals, from their differences."""
    steps = np.concatenate([np.diff(part) for part in parts])
    return robust_std(steps) / float(np.sqrt(2.0)) if len(steps) else 1.0


def _rows(setting: Setting, m: int) -> Rows:
    """Return the residuals of a manoeuvre in order of time, without each output's mean."""
    order = setting.records[m].order
    channel, residual = setting.assembly.channel[order], setting.residual[order]
    for c in np.unique(channel):
        residual[channel == c] -= residual[channel == c].mean()
    return Rows(setting.assembly.t[order], channel, residual, setting.records[m].motion)
