"""Channels: physical quantities with units, each with separate stamps on the vehicle's clock."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from advisor.process.arrays import FloatArray

# Channels that the advisor knows, with SI units. Alpha, pitch rate and pitch are positive nose up; elevator
# is positive trailing edge down; body z points down. Sideslip is positive with wind from the right. A
# positive aileron rolls to the left, a positive rudder yaws to the left.
UNITS = {
    "elevator": "rad",
    "aileron": "rad",
    "rudder": "rad",
    "throttle": "1",
    "alpha": "rad",
    "beta": "rad",
    "q": "rad/s",
    "p": "rad/s",
    "r": "rad/s",
    "theta": "rad",
    "bank": "rad",
    "a_x": "m/s^2",
    "a_y": "m/s^2",
    "a_z": "m/s^2",
    "airspeed": "m/s",
    "climb_rate": "m/s",
    "height": "m",
}
AIR_UNITS = {"altitude": "m", "static_pressure": "Pa"}
"""Units of the channels that are used only for the air density. The altitude is above mean sea level."""
WIND_UNITS = {"wind_along": "m/s", "wind_right": "m/s"}
"""Units of the wind along the aircraft's heading and to its right."""
ALL_UNITS = UNITS | AIR_UNITS | WIND_UNITS
"""Unit of every channel in a manoeuvre or a whole flight, by the channel's name."""


@dataclass(frozen=True, slots=True, eq=False)
class Channel:
    """One physical quantity over time. A gap is a longer interval between stamps, because samples are never
    resampled."""

    name: str
    t: FloatArray
    """Shape (n,): strictly increasing stamps, s since boot."""
    y: FloatArray
    """Shape (n,): values, SI."""
    source: str = ""
    """Message and field of the channel, e.g. ``AOA_SSA.AOA``."""
    provenance: str = "unknown"
    """Kind of origin: ``vane``, ``derived``, ``simulated``, ``measured``, ``commanded`` or ``unknown``."""
    delay_s: float = 0.0
    """Known delay of the values relative to their stamps, s, such as that of an autopilot's filter."""
    gain: float = 1.0
    """Mean factor from the logged values to these values, such as from indicated to true air speed."""

    def __len__(self) -> int:
        return len(self.t)

    def cut(self, start_s: float, end_s: float) -> "Channel":
        """Return the samples with ``start_s <= t <= end_s``."""
        i, j = np.searchsorted(self.t, [start_s, np.nextafter(end_s, np.inf)])
        return replace(self, t=self.t[i:j], y=self.y[i:j])

    @property
    def rate_hz(self) -> float:
        """Median sampling rate, Hz; NaN with fewer than two samples."""
        return float(1.0 / np.median(np.diff(self.t))) if len(self.t) > 1 else float("nan")

    @property
    def largest_gap_s(self) -> float:
        """Longest time between two stamps, s; infinite with fewer than two samples."""
        return float(np.max(np.diff(self.t))) if len(self.t) > 1 else float("inf")


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


_MEDIAN = 0.6745
"""Median absolute value of a normal variable of unit variance."""


def robust_std(departures: FloatArray) -> float:
    """Return the standard deviation of normal noise from the median absolute deviation, robust to outliers.

    Parameters
    ----------
    departures
        Shape (n,), n > 0: samples minus their centre.
    """
    return float(np.median(np.abs(departures))) / _MEDIAN


def rms(x: FloatArray) -> float:
    """Return the root of the mean square of samples, shape (n,), n > 0."""
    return float(np.sqrt(np.mean(x**2)))
