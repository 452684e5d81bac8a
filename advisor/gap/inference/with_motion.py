"""Part of a residual that grows with the motion, and repeats in every manoeuvre.

A law that a simulator lacks acts whenever the aircraft moves, in every manoeuvre. Moving air, drift and
noise act before, during and after an input alike. The squared residual is a level of each manoeuvre plus a
share of the squared motion. Only that share is evidence for a missing law.
"""

from collections.abc import Sequence

import numpy as np

from advisor.process.arrays import FloatArray

BIN_S = 0.5
"""Numerical: length of a bin, s: longer than a coloured residual's memory, shorter than the motion's
decay."""
WITNESSES = 3
"""Least number of manoeuvres that show that a residual repeats: two of three always agree by chance alone."""


def moving_power(residuals: Sequence[FloatArray], motions: Sequence[FloatArray]) -> tuple[float, float, int]:
    """Return the mean square of the residual that grows with the motion, its error, and the freedom of that.

    The share of the squared motion is estimated with a level of each manoeuvre. A share that does not repeat
    has a large error.

    Parameters
    ----------
    residuals, motions
        Per manoeuvre, shape (bins,): mean square of the residual and of the motion in bins of equal length.

    Returns
    -------
    power, error, freedom
        Mean square, below 0 where the residual falls while the motion grows; its standard error, from the
        scatter between manoeuvres; and manoeuvres less one. All are 0 with fewer than three manoeuvres.
    """
    about = [motion - np.mean(motion) for motion in motions]
    power = np.array([float(x @ x) for x in about])
    pull = np.array([float(x @ residual) for x, residual in zip(about, residuals, strict=True)])
    if len(residuals) < WITNESSES or np.sum(power) <= 0.0:
        return 0.0, 0.0, 0
    share = float(np.sum(pull) / np.sum(power))
    # Leave-one-out (jackknife) error of a ratio of sums.
    without = (np.sum(pull) - pull) / np.maximum(np.sum(power) - power, 1e-300)
    n = len(without)
    error = float(np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)))
    moved = float(np.mean(np.concatenate(motions)))
    return share * moved, error * moved, n - 1
