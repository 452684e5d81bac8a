"""A track: samples of one channel from one source as they arrive, with bounded memory."""

from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.signals.power_on import Extremes
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray, IntArray

_WINDOW_S = 10.0
"""Length of vehicle time over which samples are counted, s: longer than most manoeuvres."""
_LEAST_S = 5.0
"""Least time between the first and the last sample for a valid rate, s: half of ``_WINDOW_S``."""


class BestRate:
    """Fastest rate of a channel over all ten-second periods since boot.

    A sample is counted if its stamp is newer than all earlier stamps. A packet that arrives twice is counted
    once, and the size of batches makes no difference.
    """

    def __init__(self) -> None:
        self._best_hz = np.nan
        self._window = -1.0
        self._first_s = self._last_s = -np.inf
        self._count = 0

    def add(self, t: FloatArray) -> None:
        """Take stamps, s since boot, shape (n,), in order of arrival."""
        newest = np.maximum.accumulate(np.concatenate(([self._last_s], t)))
        fresh = t[t > newest[:-1]]
        while len(fresh) > 0:
            window = float(fresh[0] // _WINDOW_S)
            end = int(np.searchsorted(fresh, (window + 1.0) * _WINDOW_S))
            stamps, fresh = fresh[:end], fresh[end:]
            if window != self._window:
                self._best_hz = self.rate_hz
                self._window, self._count, self._first_s = window, 0, float(stamps[0])
            self._count += len(stamps)
            self._last_s = float(stamps[-1])

    @property
    def rate_hz(self) -> float:
        """Best rate, samples per second; from the whole time if no period is long enough. NaN with a single
        sample."""
        span_s = self._last_s - self._first_s
        if not (self._count > 1 and span_s > 0.0):
            return self._best_hz
        rate_hz = (self._count - 1) / span_s
        if span_s >= _LEAST_S:
            return float(np.fmax(rate_hz, self._best_hz))
        return rate_hz if np.isnan(self._best_hz) else self._best_hz


@dataclass(frozen=True, slots=True)
class ChannelStatus:
    """Arrival status of one channel: rate, gap and range."""

    source: str
    provenance: str
    rate_hz: float
    """Samples per second over the newest ten seconds of the channel."""
    largest_gap_s: float
    """Longest time between two stamps since boot."""
    last_s: float
    """Vehicle time of the newest sample."""
    best_hz: float = np.nan
    """Samples per second over the best ten seconds since boot."""
    lowest: float = np.nan
    """Smallest value since boot, SI."""
    highest: float = np.nan
    """Largest value since boot, SI."""
    newest: float = np.nan
    """Value of the newest sample, SI."""

    def at_best(self, earlier: "ChannelStatus | None" = None) -> "ChannelStatus":
        """Return the status with the best rate and the range of this source over all boots.

        Parameters
        ----------
        earlier
            Earlier result of this method for the channel.
        """
        best = replace(self, rate_hz=self.best_hz)
        if earlier is None or earlier.source != self.source:
            return best if earlier is None or not self.best_hz <= earlier.rate_hz else earlier
        return replace(
            best,
            rate_hz=float(np.fmax(self.best_hz, earlier.rate_hz)),
            lowest=float(np.fmin(self.lowest, earlier.lowest)),
            highest=float(np.fmax(self.highest, earlier.highest)),
        )


class Track:
    """Buffer of samples that grows at its end and drops its beginning.

    Late packets are kept, and are sorted in when a stretch is cut. Duplicate samples are dropped when a
    stretch is cut. Gaps, rates and ranges are counted when somebody asks, because samples arrive in
    many small batches.
    """

    def __init__(self, name: str, source: str, provenance: str) -> None:
        self.name = name
        self.source = source
        self.provenance = provenance
        self.newest_s = -np.inf
        self.newest = np.nan
        """Value of the sample with the newest stamp, ``newest_s``."""
        self._largest_gap_s = 0.0
        self._best = BestRate()
        self._lowest, self._highest = np.inf, -np.inf
        self._extremes = Extremes()
        self._counted, self._counted_s = 0, np.nan
        """Number of samples in the buffer that are counted, and the newest stamp of all counted samples."""
        self._t = np.empty(1024)
        self._y = np.empty(1024)
        self._order = np.empty(1024, dtype=np.int64)
        self._size = 0
        self._keep_from_s = -np.inf
        self._status: ChannelStatus | None = None

    def append(self, t: FloatArray, y: FloatArray, order: IntArray) -> None:
        """Take samples in order of arrival."""
        if len(t) == 0:
            return
        self._status = None
        latest = int(t.argmax())
        if t[latest] > self.newest_s:
            self.newest_s, self.newest = float(t[latest]), float(y[latest])
        self._make_room(len(t))
        new = slice(self._size, self._size + len(t))
        self._t[new], self._y[new], self._order[new] = t, y, order
        self._size = new.stop

    @property
    def lowest(self) -> float:
        """Smallest value since boot, SI."""
        self._count()
        return self._lowest

    @property
    def highest(self) -> float:
        """Largest value since boot, SI."""
        self._count()
        return self._highest

    @property
    def extremes(self) -> Extremes:
        """Extremes of the whole power-on, in bounded memory."""
        self._count()
        return self._extremes

    def forget(self, before_s: float) -> None:
        """Drop samples older than ``before_s`` when room is needed."""
        self._keep_from_s = before_s

    def cut(self, start_s: float, end_s: float, up_to_order: int | None = None) -> Channel:
        """Return the samples with ``start_s <= t <= end_s`` that had arrived by ``up_to_order``."""
        t, y = self._t[: self._size], self._y[: self._size]
        wanted = (t >= start_s) & (t <= end_s)
        if up_to_order is not None:
            wanted &= self._order[: self._size] <= up_to_order
        t, y = t[wanted], y[wanted]
        t, first = np.unique(t, return_index=True)
        return Channel(self.name, t, y[first], self.source, self.provenance)

    @property
    def status(self) -> ChannelStatus:
        if self._status is not None:
            return self._status
        self._count()
        recent = self.cut(self.newest_s - 10.0, self.newest_s)
        gap = self._largest_gap_s if self._size > 1 else float("inf")
        span = float(recent.t[-1] - recent.t[0]) if len(recent) > 1 else 0.0
        rate = (len(recent) - 1) / span if span > 0.0 else float("nan")
        self._status = ChannelStatus(
            self.source,
            self.provenance,
            rate,
            gap,
            self.newest_s,
            self._best.rate_hz,
            self._lowest,
            self._highest,
            self.newest,
        )
        return self._status

    def _count(self) -> None:
        """Count the samples since the last call."""
        t, y = self._t[self._counted : self._size], self._y[self._counted : self._size]
        if len(t) == 0:
            return
        before = t[0] if np.isnan(self._counted_s) else self._counted_s
        newest = np.maximum.accumulate(np.concatenate(([before], t)))
        self._largest_gap_s = max(self._largest_gap_s, float((newest[1:] - newest[:-1]).max()))
        self._counted, self._counted_s = self._size, float(newest[-1])
        self._best.add(t)
        self._extremes.add(t, y)
        self._lowest, self._highest = min(self._lowest, float(y.min())), max(self._highest, float(y.max()))

    def _make_room(self, n: int) -> None:
        if self._size + n <= len(self._t):
            return
        self._count()
        kept = self._t[: self._size] >= self._keep_from_s
        size = int(np.count_nonzero(kept))
        capacity = max(1024, 2 * (size + n))
        for name in ("_t", "_y", "_order"):
            old = getattr(self, name)
            grown = np.empty(capacity, dtype=old.dtype)
            grown[:size] = old[: self._size][kept]
            setattr(self, name, grown)
        self._size = self._counted = size
        self._counted_s = self._counted_s if size else np.nan
