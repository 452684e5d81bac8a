"""The part of an axis that a plot shows, and the sample at the cursor."""

from dataclasses import dataclass, replace

import numpy as np

from advisor.process.arrays import FloatArray

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
