"""Record of a whole power-on of the vehicle: every channel from its first stamp to its last, in bounded
memory.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray, IntArray

MOST = 600
"""Largest number of stretches, about the number of dots across a terminal. With more stretches, neighbours
are joined."""
_FIRST_S = 0.25
"""Initial length of a stretch, s: half a step of the quickest input."""


@dataclass(frozen=True, slots=True, eq=False)
class Course:
    """A channel over time, as its smallest and largest values in stretches of equal length."""

    t: FloatArray
    """Shape (n,): middle of each stretch with samples, s since boot."""
    low: FloatArray
    """Shape (n,): smallest value in each stretch, SI."""
    high: FloatArray
    """Shape (n,): largest value in each stretch, SI."""


class Extremes:
    """Smallest and largest values of one channel, collected from batches of any size."""

    def __init__(self) -> None:
        self._begin_s = np.nan
        self._length_s = _FIRST_S
        self._low = np.full(MOST, np.inf)
        self._high = np.full(MOST, -np.inf)

    def add(self, t: FloatArray, y: FloatArray) -> None:
        """Take stamps and values of samples, shape (n,) each. Samples before the first stretch are
        dropped."""
        if np.isnan(self._begin_s):
            self._begin_s = float(t[0])
        late = t >= self._begin_s
        t, y = t[late], y[late]
        if len(t) == 0:
            return
        since_s = t - self._begin_s
        while float(np.max(since_s)) / self._length_s >= MOST:
            self._halve()
        places = (since_s / self._length_s).astype(np.intp)
        np.minimum.at(self._low, places, y)
        np.maximum.at(self._high, places, y)

    @property
    def course(self) -> Course:
        """Smallest and largest values of the channel so far."""
        filled = np.flatnonzero(self._high >= self._low)
        t = np.asarray(self._begin_s + (filled + 0.5) * self._length_s, dtype=np.float64)
        return Course(t, self._low[filled], self._high[filled])

    def _halve(self) -> None:
        """Join neighbouring stretches, so that each is twice as long."""
        half = MOST // 2
        low, high = self._low.reshape(half, 2).min(axis=1), self._high.reshape(half, 2).max(axis=1)
        self._low, self._high = np.full(MOST, np.inf), np.full(MOST, -np.inf)
        self._low[:half], self._high[:half] = low, high
        self._length_s *= 2.0


@dataclass(frozen=True, slots=True)
class PowerOn:
    """All channels that one vehicle sent from one power-on to the next.

    A stream keeps power-ons only on request, because their memory grows with the flight.
    """

    boot: int
    """Number of the power-on in its log, 0 for the first."""
    channels: Mapping[str, Channel]
    """Samples of each channel from its best source, SI, by the channel's name."""
    clock_order: IntArray
    """Shape (n,), rising: arrival index of each message with a stamp of the vehicle's clock."""
    clock_s: FloatArray
    """Shape (n,), never falling: vehicle's clock at each arrival in ``clock_order``, s since boot."""
    modes: tuple[tuple[float, str], ...] = ()
    """Vehicle time of each flight mode change, s since boot (NaN before the first clock stamp), and the
    mode's name."""

    def arrivals(self, start_s: float, end_s: float) -> tuple[int, int]:
        """Return the arrival indices of the clock's first and last stamp with ``start_s <= t <= end_s``.

        Raises
        ------
        ValueError
            The clock has no stamp within this stretch.
        """
        i, j = np.searchsorted(self.clock_s, [start_s, np.nextafter(end_s, np.inf)])
        if i == j:
            raise ValueError("the vehicle's clock shows no time of this stretch")
        return int(self.clock_order[i]), int(self.clock_order[j - 1])
