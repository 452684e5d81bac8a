"""Parts of a screen, and lines of plain text that are painted only after a change."""

from abc import abstractmethod
from collections.abc import Iterable
from functools import lru_cache
from math import nan
from textwrap import wrap
from typing import ClassVar

from textual.events import Resize
from textual.widgets import Static

from advisor.session.view import View


class Part:
    """Widget that receives each new `View`."""

    EITHER_AXIS: ClassVar[bool] = False
    """Whether the part can show roll and yaw. Any other part shows only pitch."""

    @property
    def wants_showing(self) -> bool:
        """Whether the part is visible, so that it must be painted."""
        return True

    @abstractmethod
    def show(self, view: View) -> None:
        """Show the state of a new moment. The update is fast if no data of the part have changed."""


class Redrawn:
    """Widget that is drawn anew after a change of its size."""

    def on_resize(self, event: Resize) -> None:
        """Draw as much as has room."""
        self._redraw()

    @abstractmethod
    def _redraw(self) -> None:
        """Draw the newest data at the present size."""


class Lines(Static):
    """Lines of plain text, because texts of vehicles and people may contain brackets."""

    def __init__(self, text: str = "", *, id: str | None = None) -> None:
        super().__init__(text, id=id, markup=False)
        self._text = text

    def write(self, text: str) -> None:
        """Show another text in the widget. An unchanged text takes no time, and a text of unchanged height
        needs no new layout."""
        if text != self._text:
            higher = self._rows(text) != self._rows(self._text)
            self._text = text
            self.update(text, layout=higher)

    def _rows(self, text: str) -> float:
        """Return the number of rows of a text. NaN, which is equal to no number, means that the text must be
        wrapped.
        """
        height = self.styles.height
        if height is not None and not height.is_auto:
            return height.value
        lines = text.split("\n")
        return len(lines) if max(map(len, lines)) <= self.size.width else nan


Labelled = tuple[str, str]
"""A label, and the text after the label."""

_LEAST = 20
"""Least number of columns for the text after a label. With fewer columns, the text continues at the left
edge."""


class HangingLines(Redrawn, Lines):
    """Rows of label and text, wrapped at the width of the widget."""

    def __init__(self, text: str = "", *, id: str | None = None) -> None:
        super().__init__(text, id=id)
        self._labelled: tuple[Labelled, ...] = ()

    def write_rows(self, rows: Iterable[Labelled]) -> None:
        """Show other rows in the widget. Unchanged rows take no time."""
        self._labelled = tuple(rows)
        self._redraw()

    def _redraw(self) -> None:
        width = self.size.width
        if width and self._labelled:
            self.write("\n".join(_wrapped(label, text, width) for label, text in self._labelled))


@lru_cache(maxsize=2000)
def _wrapped(label: str, text: str, width: int) -> str:
    """Wrap one row to a width, into as many lines as needed."""
    indent = " " * len(label) if width - len(label) >= _LEAST else ""
    lines = wrap(label + text, width, subsequent_indent=indent, drop_whitespace=True, break_on_hyphens=False)
    return "\n".join(lines)
