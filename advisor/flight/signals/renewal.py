"""Detection of new values among old ones that are sent again under new stamps."""

import numpy as np

from advisor.flight.signals.messages import FloatArray

_MOSTLY_NEW = 0.7
"""Least share of new values at which no value counts as repeated."""
_FEW_LEVELS = 16
"""Most different values of a channel that counts as coarse. A repeated estimate takes another value at each
renewal."""


def renewed(t: FloatArray, y: FloatArray, fewest: int = 1) -> tuple[FloatArray, FloatArray]:
    """Return only samples with a new value where a channel repeats values; ``t`` and ``y`` of shape (n,).

    A channel with fewer than ``fewest`` new samples is stuck, and stays as it is. A channel with few
    different values is coarse, and stays as it is.
    """
    new = np.concatenate(([True], np.diff(y) != 0.0))
    if np.mean(new) >= _MOSTLY_NEW or np.count_nonzero(new) < fewest:
        return t, y
    levels = len(np.unique(y))
    if levels <= _FEW_LEVELS and levels < np.count_nonzero(new):
        return t, y
    return t[new], y[new]
