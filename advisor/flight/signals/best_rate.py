"""Rate of a channel at its best: one number for a whole log, independent of cuts and switches."""

import numpy as np

from advisor.flight.signals.messages import FloatArray

_WINDOW_S = 10.0
"""Stretch of vehicle time over which samples are counted, s: longer than most manoeuvres."""
_LEAST_S = 5.0
"""Least time between the first and the last sample of a stretch that counts, s: half of ``_WINDOW_S``."""


class BestRate:
    """Counts the samples of each ten seconds since boot and keeps the fastest count.

    A sample counts when its stamp is newer than all before. So a packet that comes twice counts once, and the
    size of batches makes no difference.
    """

    def __init__(self) -> None:
        self._best_hz = np.nan
        self._window = -1.0
        self._first_s = self._last_s = -np.inf
        self._count = 0

    def add(self, t: FloatArray) -> None:
        """Take stamps in s since boot, shape (n,), in order of arrival."""
        newest = np.maximum.accumulate(np.concatenate(([self._last_s], t)))
        fresh = t[t > newest[:-1]]
        windows, starts = np.unique(np.floor(fresh / _WINDOW_S), return_index=True)
        for window, stamps in zip(windows.tolist(), np.split(fresh, starts[1:]), strict=False):
            if window != self._window:
                self._best_hz = self.rate_hz
                self._window, self._count, self._first_s = window, 0, float(stamps[0])
            self._count += len(stamps)
            self._last_s = float(stamps[-1])

    @property
    def rate_hz(self) -> float:
        """Best rate in samples per second, from the whole time where no stretch is long enough. NaN with one
        sample."""
        span_s = self._last_s - self._first_s
        if not (self._count > 1 and span_s > 0.0):
            return self._best_hz
        rate_hz = (self._count - 1) / span_s
        if span_s >= _LEAST_S:
            return float(np.fmax(rate_hz, self._best_hz))
        return rate_hz if np.isnan(self._best_hz) else self._best_hz
