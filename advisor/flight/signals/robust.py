"""Size of noise, with and without outliers."""

import numpy as np

from advisor.process.arrays import FloatArray

_MEDIAN = 0.6745
"""Median absolute value of a normal variable of unit variance."""


def robust_std(departures: FloatArray) -> float:
    """Return the standard deviation of normal noise from the median absolute deviation, robust to outliers.

    Parameters
    ----------
    departures
        Shape (n,), n > 0: samples minus their centre.
    """
    return float(np.median(np.abs(departures))) / _MEDIAN


def rms(x: FloatArray) -> float:
    """Return the root of the mean square of samples, shape (n,), n > 0."""
    return float(np.sqrt(np.mean(x**2)))
