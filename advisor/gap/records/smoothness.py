"""Smoothness of a record: white noise or a filter before storage, from differences of raw samples.

In quiet stretches, differences of white noise are equally large over one and over two samples. Moving air is
a first-order process at short times, and its differences grow by at most √2. Differences of filtered records
grow by more.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.record import robust_std
from advisor.process.arrays import FloatArray

_WEIGHTS = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
"""Numerical: weights of a fourth difference."""
_SMOOTHED = 2.0
"""Growth of the differences above which the record was filtered. ArduPilot's estimates show 2.4 and more."""
_FILTERED = 6.0
"""Growth of the differences above which a low-pass filter removed almost all noise above its cutoff. No
estimator on board smooths so strongly."""


def white_part(series: Sequence[FloatArray], stride: int = 1) -> float:
    """Return the standard deviation of the white noise in stretches of one channel, from fourth differences.

    The median of |d| replaces the mean square, because steps of the motion are few and large.
    """
    differences = []
    for y in series:
        n = len(y) - (len(_WEIGHTS) - 1) * stride
        if n > 0:
            differences.append(sum(w * y[k * stride : k * stride + n] for k, w in enumerate(_WEIGHTS)))
    if not differences:
        return 0.0
    return robust_std(np.concatenate(differences)) / float(np.sqrt(np.sum(_WEIGHTS**2)))


def is_smoothed(quiet: Sequence[FloatArray]) -> bool:
    """Return whether quiet stretches are smoother than instruments and moving air allow."""
    return _growth(quiet) > _SMOOTHED


def is_filtered(quiet: Sequence[FloatArray]) -> bool:
    """Return whether quiet stretches are as smooth as after a low-pass filter on the ground."""
    return _growth(quiet) > _FILTERED


def _growth(quiet: Sequence[FloatArray]) -> float:
    """Return the ratio of the differences over two samples to those over one; 0 for a constant series."""
    white = white_part(quiet)
    return white_part(quiet, stride=2) / white if white > 0.0 else 0.0
