"""New values, or old ones sent again under fresh stamps."""

import numpy as np

from advisor.flight.messages import FloatArray

_MOSTLY_NEW = 0.7
"""Share of new values from which on nothing is sent twice."""
_FEW_LEVELS = 16
"""Different values up to which a channel that comes back to them reads in coarse steps: an estimate that is
sent again takes another value each time that it is renewed."""


def renewed(t: FloatArray, y: FloatArray, fewest: int = 1) -> tuple[FloatArray, FloatArray]:
    """Only samples that bring a new value, when a channel repeats old ones; ``t`` and ``y`` of shape (n,).

    Where fewer than ``fewest`` would be left, the sensor is stuck, and was read all the same; where it takes
    few values, it reads in coarse steps.
    """
    new = np.concatenate(([True], np.diff(y) != 0.0))
    if np.mean(new) >= _MOSTLY_NEW or np.count_nonzero(new) < fewest:
        return t, y
    levels = len(np.unique(y))
    if levels <= _FEW_LEVELS and levels < np.count_nonzero(new):
        return t, y
    return t[new], y[new]
