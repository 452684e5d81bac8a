"""Commands that consist of sines, between their samples.

Straight lines between the samples of a sine lose the fraction (πf/f_s)²/3 on average: 1 % at 2.8 Hz and 50
samples a second. The loss grows with the frequency like the loss by a servo's lag. On a fast roll the loss
moved L_p by 5 %.
"""

from dataclasses import replace

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

_PARTS = 4
"""Number of straight lines between two samples. Four lines lose a sixteenth of the loss of one line."""


def command_of(maneuver: Maneuver, control: str) -> Channel:
    """Return the command of a control, without the samples before the record.

    A command that consists of sines gets further points between its samples.
    """
    command = maneuver.channels[control]
    if maneuver.span.kind != "multisine":
        return command
    kept = np.isfinite(command.y)
    t, y = between_samples(command.t[kept], command.y[kept])
    return replace(command, t=t, y=y)


def between_samples(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return times and values of a cubic spline through samples, with further points between the samples."""
    from scipy.interpolate import CubicSpline  # not on the start path

    part = np.arange(_PARTS) / _PARTS
    fine = np.append((t[:-1, None] + np.diff(t)[:, None] * part).ravel(), t[-1])
    return fine, CubicSpline(t, y)(fine)
