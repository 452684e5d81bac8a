"""Axes (ranges and ticks at round numbers, in equal steps or ratios), and the window that a user moves."""

from dataclasses import dataclass, replace
from math import ceil, floor, log10

import numpy as np

from advisor.process.arrays import FloatArray

_FINENESS = 8
"""Number of grains in the length of an axis. The ends are rounded to a grain, an eighth of the length."""


@dataclass(frozen=True, slots=True)
class Axis:
    """Axis with rounded ends and the step of its ticks. The ends stay unchanged while new data lie between
    them.
    """

    low: float
    high: float
    step: float

    @property
    def ticks(self) -> list[float]:
        """Multiples of ``step`` from ``low`` to ``high``."""
        first, last = ceil(self.low / self.step - 1e-9), floor(self.high / self.step + 1e-9)
        return [k * self.step for k in range(first, last + 1)]

    @property
    def labels(self) -> list[str]:
        """Texts of the ticks, with as many decimals as the step needs."""
        decimals = max(0, -floor(log10(self.step) + 1e-9))
        return [f"{tick:.{decimals}f}" for tick in self.ticks]


@dataclass(frozen=True, slots=True)
class LogAxis:
    """Logarithmic axis with ticks at 1, 2 and 5 times powers of ten, or at powers of ten alone."""

    low: float
    """Decimal logarithm of the value at the lower end."""
    high: float
    """Decimal logarithm of the value at the upper end."""
    values: tuple[float, ...]
    """Values of the ticks, rising."""

    @property
    def ticks(self) -> list[float]:
        """Decimal logarithms of ``values``."""
        return [log10(value) for value in self.values]

    @property
    def labels(self) -> list[str]:
        """Texts of the values, without an exponent: ``25``, ``2,500``."""
        return [f"{value:,.0f}" if value >= 1.0 else f"{value:g}" for value in self.values]


def log_axis(values: list[FloatArray], most: int) -> LogAxis:
    """Choose the logarithmic axis that holds all positive values, with about ``most`` ticks and at least two.

    Parameters
    ----------
    values : list of ndarray
        Data of any lengths. Values that are not positive and finite are left out; without any value the range
        is 1 to 10.
    most : int
        Wanted number of ticks, at least 2.
    """
    positive = np.concatenate([v[np.isfinite(v) & (v > 0.0)] for v in values] or [np.empty(0)])
    low, high = (float(positive.min()), float(positive.max())) if len(positive) else (1.0, 10.0)
    bottom, top = _round_up(low / 2.2), _round_up(high * 1.05)
    first, last = floor(log10(bottom) + 1e-9), ceil(log10(top) - 1e-9)
    fine = [m * 10.0**k for k in range(first, last + 1) for m in (1.0, 2.0, 5.0)]
    ticks = [value for value in fine if bottom * (1 - 1e-9) <= value <= top * (1 + 1e-9)]
    every = 1
    while len(ticks) > max(most, 2):
        decades = [10.0**k for k in range(first, last + 1) if k % every == 0]
        sparser = [value for value in decades if bottom * (1 - 1e-9) <= value <= top * (1 + 1e-9)]
        if len(sparser) < 2:
            break
        ticks, every = sparser, every + 1
    return LogAxis(log10(bottom), log10(top), tuple(ticks))


def round_axis(values: list[FloatArray], intervals: int) -> Axis:
    """Choose the axis that holds all finite values, with about ``intervals`` steps and at least two ticks.

    Parameters
    ----------
    values : list of ndarray
        Data of any lengths; empty or not finite data give the range 0 to 1.
    intervals : int
        Wanted number of steps of 1, 2 or 5 times a power of ten, at least 1.
    """
    finite = [v[np.isfinite(v)] for v in values]
    finite = [v for v in finite if len(v)]
    low = min((float(v.min()) for v in finite), default=0.0)
    high = max((float(v.max()) for v in finite), default=1.0)
    if high - low <= 1e-9 * max(abs(low), abs(high), 1e-12):
        margin = max(abs(low) * 0.1, 1e-6)
        low, high = low - margin, high + margin
    grain = _round_up((high - low) / _FINENESS)
    low, high = floor(low / grain + 1e-9) * grain, ceil(high / grain - 1e-9) * grain
    axis = Axis(low, high, _round_up((high - low) / max(intervals, 1)))
    while len(axis.ticks) < 2:
        axis = Axis(low, high, _round_up(axis.step * 0.4))
    return axis


def exact_axis(low: float, high: float, intervals: int) -> Axis:
    """Choose the axis for a range with fixed ends, with about ``intervals`` steps and at least three ticks.

    Parameters
    ----------
    low, high
        Ends of the range; low is below high.
    intervals
        Wanted number of steps of 1, 2 or 5 times a power of ten, at least 1.
    """
    axis = Axis(low, high, _round_up((high - low) / max(intervals, 1)))
    while len(axis.ticks) < 3:
        axis = Axis(low, high, _round_up(axis.step * 0.4))
    return axis


def _round_up(step: float) -> float:
    """Return the smallest number at or above the value that is 1, 2 or 5 times a power of ten."""
    magnitude = 10.0 ** floor(log10(step))
    return next(m * magnitude for m in (1.0, 2.0, 5.0, 10.0) if m * magnitude >= step * (1.0 - 1e-9))


_LEAST_SHARE = 0.01
"""Shortest visible part, as a fraction of the whole axis. A hundredth of a record of 12 s holds six samples
at 50 Hz.
"""


@dataclass(frozen=True, slots=True)
class Window:
    """Visible part of a longer range of an axis. Every change keeps the visible part inside the range."""

    first: float
    last: float
    """Both ends of the whole range of the axis."""
    low: float
    high: float
    """Both ends of the visible part of the axis."""

    @classmethod
    def whole(cls, first: float, last: float) -> "Window":
        return cls(first, last, first, last)

    @property
    def zoomed(self) -> bool:
        """Whether less than the whole range is shown."""
        return (self.low, self.high) != (self.first, self.last)

    @property
    def shown(self) -> tuple[float, float]:
        """Ends of the visible part, the lower first."""
        return self.low, self.high

    def zoom(self, factor: float, about: float) -> "Window":
        """Return a window with ``1/factor`` of the present length. The value ``about`` keeps its place in the
        plot.
        """
        length = self.high - self.low
        about = min(max(about, self.low), self.high)
        wanted = max(length / factor, _LEAST_SHARE * (self.last - self.first))
        low = about - (about - self.low) / length * wanted
        return self._placed(low, wanted)

    def pan(self, share: float) -> "Window":
        """Move the visible part by a fraction of its length. A positive fraction moves towards the last
        value.
        """
        length = self.high - self.low
        return self._placed(self.low + share * length, length)

    def showing(self, value: float) -> "Window":
        """Move the visible part as little as possible to show a value."""
        length = self.high - self.low
        low = min(self.low, max(value, self.first))
        low = max(low, min(value, self.last) - length)
        return self._placed(low, length)

    def over(self, first: float, last: float) -> "Window":
        """Take another range. Return the window over a new range. A window on the whole range shows the whole
        new range, and a zoomed window keeps its length and place.
        """
        if not self.zoomed:
            return Window.whole(first, last)
        return Window(first, last, self.low, self.high)._placed(self.low, self.high - self.low)

    def _placed(self, low: float, length: float) -> "Window":
        length = min(length, self.last - self.first)
        low = min(max(low, self.first), self.last - length)
        high = self.last if length == self.last - self.first else low + length
        return Window(self.first, self.last, low, high)


def nearest(x: FloatArray, value: float) -> int:
    """Return the index of the element of ``x`` that lies nearest to a value.

    Parameters
    ----------
    x
        Shape (n,) with n at least 1, in rising order.
    """
    at = int(np.searchsorted(x, value))
    if at == 0 or at == len(x):
        return min(at, len(x) - 1)
    return at if x[at] - value < value - x[at - 1] else at - 1


_STEPS_ACROSS = 100
"""Number of cursor steps across the visible part."""
_ZOOM = 1.5
_PAN = 0.2


@dataclass(frozen=True, slots=True)
class Sight:
    """Visible part of the time axis, and a cursor that stands on a sample."""

    window: Window
    cursor: float | None = None
    """Time stamp of the cursor's sample; None without a cursor."""

    def over(self, first: float, last: float, stamps: FloatArray) -> "Sight":
        """Show another record. The cursor moves to the nearest sample of that record."""
        there = replace(self, window=self.window.over(first, last))
        return there if self.cursor is None else there.pointed(self.cursor, stamps)

    def pointed(self, x: float, stamps: FloatArray) -> "Sight":
        """Set the cursor on the sample nearest to ``x``; remove the cursor if there are no samples."""
        return replace(self, cursor=float(stamps[nearest(stamps, x)]) if len(stamps) else None)

    def stepped(self, direction: int, stamps: FloatArray, *, finely: bool) -> "Sight":
        """Move the cursor by a hundredth of the visible part, or by one sample.

        The window follows the cursor. Without a cursor, set one at 0 if 0 is visible, else in the middle.
        """
        low, high = self.window.shown
        if self.cursor is None or not len(stamps):
            return self.pointed(0.0 if low <= 0.0 <= high else 0.5 * (low + high), stamps)
        visible = int(((stamps >= low) & (stamps <= high)).sum())
        step = 1 if finely else max(1, visible // _STEPS_ACROSS)
        at = min(max(nearest(stamps, self.cursor) + direction * step, 0), len(stamps) - 1)
        cursor = float(stamps[at])
        return Sight(self.window.showing(cursor), cursor)

    def zoomed(self, direction: int, about: float | None = None) -> "Sight":
        """Zoom in (1) or out (-1) about a given time. The default is the cursor's time, or the middle without
        a cursor.
        """
        if about is None:
            low, high = self.window.shown
            in_sight = self.cursor is not None and low <= self.cursor <= high
            about = self.cursor if in_sight else None
            about = 0.5 * (low + high) if about is None else about
        return replace(self, window=self.window.zoom(_ZOOM**direction, about))

    def panned(self, direction: int) -> "Sight":
        """Show earlier (-1) or later (1) times."""
        return replace(self, window=self.window.pan(direction * _PAN))

    def whole(self) -> "Sight":
        """Show the whole record without a cursor."""
        return Sight(Window.whole(self.window.first, self.window.last))
