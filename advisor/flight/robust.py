"""The spread of noise among outliers."""

import numpy as np

from advisor.flight.messages import FloatArray

_MEDIAN = 0.6745
"""Median of the size of a normal variable of unit variance."""


def robust_std(departures: FloatArray) -> float:
    """Return the standard deviation of normal noise from the median size of its departures, which few
    outliers move.

    Parameters
    ----------
    departures
        Shape (n,), n > 0: samples less their centre.
    """
    return float(np.median(np.abs(departures))) / _MEDIAN
