"""The part of a time axis in sight, and the place of a cursor on the axis."""

from dataclasses import dataclass, replace

from advisor.flight.signals.messages import FloatArray
from advisor.tui.plot.window import Window, nearest

_STEPS_ACROSS = 100
"""Steps in which the cursor crosses what is shown."""
_ZOOM = 1.5
_PAN = 0.2


@dataclass(frozen=True, slots=True)
class Sight:
    """A window on the time axis and a cursor that stands on samples."""

    window: Window
    cursor: float | None = None
    """Stamp of a sample; None: there is no cursor."""

    def over(self, first: float, last: float, stamps: FloatArray) -> "Sight":
        """Look at another record; the cursor goes to its nearest sample."""
        there = replace(self, window=self.window.over(first, last))
        return there if self.cursor is None else there.pointed(self.cursor, stamps)

    def pointed(self, x: float, stamps: FloatArray) -> "Sight":
        """Set the cursor on the sample nearest to ``x``; without samples there is no cursor."""
        return replace(self, cursor=float(stamps[nearest(stamps, x)]) if len(stamps) else None)

    def stepped(self, direction: int, stamps: FloatArray, *, finely: bool) -> "Sight":
        """Move the cursor by a hundredth of what is shown, or by one sample; the window follows.

        Without a cursor, set one at 0 where 0 is in sight, else in the middle.
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
        """Zoom in (1) or out (-1) about a time, else about the cursor, else about the middle."""
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
