"""Part of a residual that grows with the motion, and repeats in every manoeuvre.

A law that a simulator lacks acts whenever the aircraft moves, in every manoeuvre. Moving air, drift and
noise act before, during and after an input alike. The squared residual is a level of each manoeuvre plus a
share of the squared motion. Only that share is evidence for a missing law.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.process.arrays import FloatArray

BIN_S = 0.5
"""Numerical: length of a bin, s: longer than a coloured residual's memory, shorter than the motion's
decay."""
WITNESSES = 3
"""Least number of manoeuvres that show that a residual repeats: two of three always agree by chance alone."""


@dataclass(frozen=True)
class MovingPower:
    """Mean square of a residual that grows with the motion."""

    power: float
    """Mean square; below 0 where the residual falls while the motion grows."""
    error: float
    """Standard error of the mean square, from the scatter between manoeuvres."""
    freedom: int
    """Degrees of freedom of the standard error: manoeuvres less one."""


_NOTHING = MovingPower(0.0, 0.0, 0)


def moving_power(residuals: Sequence[FloatArray], motions: Sequence[FloatArray]) -> MovingPower:
    """Return the mean square of the residual that grows with the motion; 0 with fewer than three manoeuvres.

    The share of the squared motion is estimated with a level of each manoeuvre. A share that does not repeat
    has a large error.

    Parameters
    ----------
    residuals, motions
        Per manoeuvre, shape (bins,): mean square of the residual and of the motion in bins of equal length.
    """
    if len(residuals) < WITNESSES:
        return _NOTHING
    about = [motion - np.mean(motion) for motion in motions]
    power = np.array([float(x @ x) for x in about])
    pull = np.array([float(x @ residual) for x, residual in zip(about, residuals, strict=True)])
    if np.sum(power) <= 0.0:
        return _NOTHING
    share = float(np.sum(pull) / np.sum(power))
    # Leave-one-out (jackknife) error of a ratio of sums.
    without = (np.sum(pull) - pull) / np.maximum(np.sum(power) - power, 1e-300)
    n = len(without)
    error = float(np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)))
    moved = float(np.mean(np.concatenate(motions)))
    return MovingPower(share * moved, error * moved, n - 1)
