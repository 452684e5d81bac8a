"""A stretch of elevator that has just come to rest, and what is asked of it more than once.

Everything is relative to the stretch itself: trim is the level at which it rests now.
"""

from typing import NamedTuple

import numpy as np

from advisor.flight.lobes import without_spikes
from advisor.flight.messages import FloatArray

RESTING_S = 0.5
"""How long the elevator must have rested before its past is looked at."""
_SLOWEST_STEP_S = 0.25
"""Samples farther apart than this hide the shape of an input."""


class Stretch(NamedTuple):
    """The elevator up to now."""

    t: FloatArray
    """Stamps, s, shape (n,)."""
    d: FloatArray
    """Deviation from trim without spikes, rad, shape (n,)."""
    largest: FloatArray
    """Largest deviation to either side from each sample until now, rad, shape (n,)."""
    trim: float
    """Level of the rest, rad."""
    rest_range: float
    """Range over the rest, rad."""
    interval_s: float
    """Median interval of the stamps."""


def at_rest(t: FloatArray, u: FloatArray) -> Stretch | None:
    """The stretch of stamps ``t`` (s) and elevator ``u`` (rad); None when they are too far apart."""
    rest = int(t.searchsorted(t[-1] - RESTING_S))
    if len(t) - rest < 3 or (interval_s := median(t[1:] - t[:-1])) > _SLOWEST_STEP_S:
        return None
    trim = median(u[rest:])
    d = without_spikes(u) - trim
    largest = np.maximum.accumulate(np.abs(d)[::-1])[::-1]
    return Stretch(t, d, largest, trim, range_of(d[rest:]), interval_s)


def median(x: FloatArray) -> float:
    """As numpy's, which on so few numbers spends its time on asking whether they are numbers."""
    middle = np.sort(x)[(len(x) - 1) // 2 : len(x) // 2 + 1]
    return float(middle.sum() / len(middle))


def range_of(x: FloatArray) -> float:
    """Largest less smallest."""
    return float(x.max() - x.min())
