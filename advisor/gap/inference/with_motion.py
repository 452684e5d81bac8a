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

    Each output's squared motion has a share of at least 0, and each manoeuvre a level. A share that does not
    repeat has a large error, by the jackknife over the manoeuvres.

    Parameters
    ----------
    residuals
        Per manoeuvre, shape (bins,): mean square of the residual in bins of equal length.
    motions
        Per manoeuvre, shape (outputs, bins): mean square of each output's motion in these bins.

    Returns
    -------
    power, error, freedom
        Mean square; its standard error, from the scatter between manoeuvres; and manoeuvres less one. All are
        0 with fewer than three manoeuvres.
    """
    from scipy.optimize import nnls  # not on the start path

    about = [motion - np.mean(motion, axis=1, keepdims=True) for motion in motions]
    left = [residual - np.mean(residual) for residual in residuals]
    n, moved = len(residuals), np.mean(np.hstack(motions), axis=1)
    if n < WITNESSES or not np.any(moved > 0.0):
        return 0.0, 0.0, 0

    def power(kept: Sequence[int]) -> float:
        shares, _ = nnls(np.hstack([about[m] for m in kept]).T, np.concatenate([left[m] for m in kept]))
        return float(shares @ moved)

    without = np.array([power([k for k in range(n) if k != m]) for m in range(n)])
    error = float(np.sqrt((n - 1) / n * np.sum((without - np.mean(without)) ** 2)))
    return power(range(n)), error, n - 1
