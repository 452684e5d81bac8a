"""Newest samples of a signal, with bounded memory."""

import numpy as np

from advisor.process.arrays import FloatArray


class Samples:
    """Samples of a signal in the order of their stamps. The oldest samples are dropped.

    Parameters
    ----------
    keep_s
        Least time for which samples are kept, s.
    """

    def __init__(self, keep_s: float) -> None:
        self._keep_s = keep_s
        self._t, self._y = np.empty(4096), np.empty(4096)
        self.size = 0
        """Number of samples."""

    @property
    def t(self) -> FloatArray:
        """Stamps in s, shape (size,), rising."""
        return self._t[: self.size]

    @property
    def y(self) -> FloatArray:
        """Values, shape (size,)."""
        return self._y[: self.size]

    @property
    def capacity(self) -> int:
        """Number of samples that the memory can hold."""
        return len(self._t)

    def append(self, t: float, y: float) -> None:
        """Append a sample. The index of the sample is then ``size − 1``."""
        if self.size == len(self._t):
            self._make_room(t - self._keep_s)
        self._t[self.size], self._y[self.size] = t, y
        self.size += 1

    def index(self, t: float) -> int:
        """Return the index of the first sample at or after ``t``."""
        return int(np.searchsorted(self.t, t))

    def since(self, t: float, until: int | None = None) -> FloatArray:
        """Return the values at or after ``t``, before the index ``until``."""
        return self.y[self.index(t) : until]

    def interval_s(self) -> float:
        """Return the median interval of the newest twenty samples, s; infinite with fewer than three."""
        recent = self.t[-20:]
        return float(np.median(np.diff(recent))) if len(recent) > 2 else np.inf

    def clear(self) -> None:
        self.size = 0

    def _make_room(self, from_s: float) -> None:
        first = self.index(from_s)
        n = self.size - first
        t, y = self.t[first:].copy(), self.y[first:].copy()
        if n > len(self._t) // 2:
            self._t, self._y = np.empty(2 * len(self._t)), np.empty(2 * len(self._y))
        self._t[:n], self._y[:n] = t, y
        self.size = n
