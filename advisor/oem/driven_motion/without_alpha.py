"""Noise of a motion whose angle of attack is not measured, so that gusts and jolts look alike."""

import numpy as np

from advisor.flight.signals.robust import robust_std
from advisor.model.outputs import OUTPUTS
from advisor.oem.driven_motion.noise import Noise
from advisor.oem.driven_motion.setting import Record, Setting
from advisor.oem.problem import ASSUMED_M_S
from advisor.oem.turbulence import Rows, Turbulence, find_turbulence

MOST_MANEUVERS = 7
"""Number of the newest manoeuvres for the noise estimate. More manoeuvres would change the noise estimate
little."""


def moving_air(setting: Setting) -> Turbulence:
    """Return the moving air and the noise that fit the residuals of a setting best."""
    rows = [_rows(setting, m) for m in range(len(setting.records))][-MOST_MANEUVERS:]
    white = np.array([_white([r.residual[r.channel == c] for r in rows]) for c in range(len(OUTPUTS))])
    matrix = setting.records[0].motion.matrix
    system = np.array([matrix[0, 0], matrix[0, 1] - 1.0, matrix[1, 0], matrix[1, 1]])
    return find_turbulence(rows, system, white, seen_by_alpha=False, start_variance=0.0)


def noise_of(air: Turbulence, record: Record) -> Noise:
    """Return moving air as noise without jolts."""
    model = air.air
    still = np.zeros(len(record.motion.forced))
    return Noise(model.white, model.coloured, model.memory_s, still, model.gust, model.gust_memory_s)


def _white(parts: list[np.ndarray]) -> float:
    """Return the standard deviation of the white part of an output's residuals, from their differences."""
    steps = np.concatenate([np.diff(part) for part in parts])
    return robust_std(steps) / float(np.sqrt(2.0)) if len(steps) else 1.0


def _rows(setting: Setting, m: int) -> Rows:
    """Return the residuals of a manoeuvre in order of time, without each output's mean."""
    order, airspeed = setting.records[m].order, setting.problem.records[m].airspeed
    channel, residual = setting.assembly.channel[order], setting.residual[order]
    for c in np.unique(channel):
        residual[channel == c] -= residual[channel == c].mean()
    speed = ASSUMED_M_S if airspeed is None else float(np.mean(airspeed.y))
    return Rows(setting.assembly.t[order], channel, residual, speed)
