"""Is noise white, or was a record filtered before it was stored? Told by differences of raw samples.

Where nothing is flown, differences of white noise are as large over two samples as over one. Moving air is a
process of first order at short times, whose differences grow by at most √2; what a filter or an
autopilot's estimator has smoothed grows by more.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.flight.robust import robust_std

_WEIGHTS = np.array([1.0, -4.0, 6.0, -4.0, 1.0])
_ROUGH = 1.6
"""Growth of differences over two samples up to which noise is an instrument's; ArduPilot's estimates have
2.4 and more ..."""
_SMOOTHED = 2.0
"""... from which on something has been filtered ..."""
_FILTERED = 6.0
"""... and from which on next to nothing is left above its edge: no estimator on board is so thorough."""


def white_part(series: Sequence[FloatArray], stride: int = 1) -> float:
    """Standard deviation of the white noise in stretches of one channel, from fourth differences.

    The median of |d| instead of the mean square: steps of the motion are few and large.
    """
    differences = []
    for y in series:
        n = len(y) - (len(_WEIGHTS) - 1) * stride
        if n > 0:
            differences.append(sum(w * y[k * stride : k * stride + n] for k, w in enumerate(_WEIGHTS)))
    if not differences:
        return 0.0
    return robust_std(np.concatenate(differences)) / float(np.sqrt(np.sum(_WEIGHTS**2)))


def is_rough(quiet: Sequence[FloatArray]) -> bool:
    """Whether stretches in which nothing was flown are as rough as white noise."""
    return white_part(quiet) > 0.0 and _growth(quiet) < _ROUGH


def is_smoothed(quiet: Sequence[FloatArray]) -> bool:
    """Whether stretches in which nothing was flown are smoother than instruments and air can be."""
    return _growth(quiet) > _SMOOTHED


def is_filtered(quiet: Sequence[FloatArray]) -> bool:
    """Whether they are as smooth as a low-pass on the ground leaves them, before a record is stored."""
    return _growth(quiet) > _FILTERED


def _growth(quiet: Sequence[FloatArray]) -> float:
    """By how much differences grow with the stride; 0 where nothing moves at all."""
    white = white_part(quiet)
    return white_part(quiet, stride=2) / white if white > 0.0 else 0.0
