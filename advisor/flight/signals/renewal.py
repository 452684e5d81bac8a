"""Detection of new values among old ones that are sent again under new stamps."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import Channel

_MOSTLY_NEW = 0.7
"""Least share of new values at which no value counts as repeated."""
_FEW_LEVELS = 16
"""Most different values of a channel that counts as coarse. An estimate that is sent several times takes
another value at each renewal."""

_MOST_COPIES = 4
"""Most times that a sender is supposed to send one message. A test input has steps of at least as many
samples, whose times could pass for a pattern of more copies."""
_BY_CHANCE = 1e-3
"""Largest probability that changes of independent samples fall into one pattern of copies."""


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


def counted_once(channel: Channel) -> Channel:
    """Return a channel without the copies of a sender that sends each value several times.

    A fit would count the noise of k copies k times. Of k copies only every k-th sample can change. A value
    that is held, as the elevator's at trim, keeps its samples, because the pattern decides.
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
