"""Detection of new values among repeated values with new stamps."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray

_MOSTLY_NEW = 0.7
"""Least share of new values above which no value counts as repeated."""
_FEW_LEVELS = 16
"""Largest number of different values in a channel of coarse resolution. An estimate that is sent several
times changes at each renewal."""

_MOST_COPIES = 4
"""Largest number of copies that a sender may send of one message. A test input has steps of at least as many
samples, which could look like more copies."""
_BY_CHANCE = 1e-3
"""Largest probability by chance that changes of independent samples form a pattern of copies."""


def renewed(t: FloatArray, y: FloatArray, fewest: int = 1) -> tuple[FloatArray, FloatArray]:
    """Return only the samples with a new value, if a channel repeats values; ``t`` and ``y`` of shape (n,).

    A channel with fewer than ``fewest`` new samples is stuck, and is returned unchanged. A channel with few
    different values is coarse, and is returned unchanged.
    """
    new = np.concatenate(([True], np.diff(y) != 0.0))
    if np.mean(new) >= _MOSTLY_NEW or np.count_nonzero(new) < fewest:
        return t, y
    levels = len(np.unique(y))
    if levels <= _FEW_LEVELS and levels < np.count_nonzero(new):
        return t, y
    return t[new], y[new]


def counted_once(channel: Channel) -> Channel:
    """Return a channel without the copies of a sender that sends each value several times.

    A fit would weight the noise of k copies k times. With k copies only every k-th sample can change. A
    constant value, such as the elevator's at trim, keeps its samples, because only a pattern of copies
    counts.
    """
    rows = _originals(channel.y)
    return channel if rows is None else replace(channel, t=channel.t[rows], y=channel.y[rows])


def _originals(y: FloatArray) -> NDArray[np.int64] | None:
    """Return the rows of ``y``, shape (n,), that are not copies of the row before; None without copies."""
    changes = np.flatnonzero(np.diff(y) != 0.0) + 1
    for copies in range(_MOST_COPIES, 1, -1):
        first = changes[:1] % copies
        if float(copies) ** (1 - len(changes)) < _BY_CHANCE and np.all(changes % copies == first):
            return np.arange(int(first[0]), len(y), copies)
    return None
