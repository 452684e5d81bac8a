"""The base of all panes, rows with a header, and lines of text."""

import csv
from abc import abstractmethod
from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from io import StringIO
from math import isfinite, nan
from textwrap import wrap
from typing import ClassVar

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.events import Resize
from textual.widgets import DataTable, Static

from advisor.session.conducting import View
from advisor.tui.plot.chart import Chart
from advisor.tui.plot.painting import Plot


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


_DIGITS = 7
"""Significant digits of a number in a table, as many as a log stores (float32)."""


@dataclass(frozen=True, slots=True)
class TableRows:
    """A table of texts and numbers."""

    header: tuple[str, ...]
    rows: tuple[tuple[object, ...], ...]

    def csv(self) -> str:
        """Write a header line and one line for each row. An unknown number becomes an empty field."""
        text = StringIO()
        lines = csv.writer(text, lineterminator="\n")
        lines.writerow(self.header)
        lines.writerows([_cell(value) for value in row] for row in self.rows)
        return text.getvalue()


def rows_of_charts(charts: Iterable[Chart]) -> TableRows:
    """Return one row for each sample of each series: quantity, series, x, y."""
    rows: list[tuple[object, ...]] = []
    x_label = "x"
    for chart in charts:
        x_label = chart.x_label or x_label
        for series in chart.series:
            pairs = zip(series.x.tolist(), series.y.tolist(), strict=True)
            rows += [(chart.y_label, series.name, x, y) for x, y in pairs]
    return TableRows(("quantity", "series", x_label, "value"), tuple(rows))


def _cell(value: object) -> object:
    if value is None:
        return ""
    if isinstance(value, float):
        return f"{value:.{_DIGITS}g}" if isfinite(value) else ""
    return value


class Pane(Part, Vertical):
    """Framed part of a screen. A pane takes the focus, explains itself, shows a `View`, and gives its content
    as text.
    """

    TITLE: ClassVar[str] = ""
    SHORT: ClassVar[str] = ""
    """Short title of the pane, for a line of 80 columns with all titles."""
    OF_ELEVATOR: ClassVar[bool] = False
    """Whether the pane shows only pitch, whichever axis other panes show."""
    OF_SELECTED: ClassVar[bool] = False
    """Whether the pane shows the selected manoeuvre."""
    HELP = ""
    """Help text on the content and use of the pane."""
    can_focus = True
    """Whether the pane takes the focus. A pane whose table or text takes the keys does not take the focus."""

    _parts: tuple[object, ...] = ()
    """Data that were painted last."""

    def on_mount(self) -> None:
        """Write the pane's title into its frame."""
        self.border_title = self.TITLE

    @property
    def wants_showing(self) -> bool:
        """Whether the pane is visible. Only visible panes are updated."""
        return bool(self.display)

    def changed(self, *parts: object) -> bool:
        """Return whether a part is another object than at the last call. If so, the pane must be painted."""
        same = len(parts) == len(self._parts) and all(a is b for a, b in zip(parts, self._parts, strict=True))
        self._parts = parts
        return not same

    def subtitle(self, text: str) -> None:
        """Write into the lower edge of the frame. An unchanged text takes no time."""
        if text != self.border_subtitle:
            self.border_subtitle = text

    def rows(self) -> TableRows | None:
        """Return the cells of the pane's table, or the values of its curves; None for a pane of text."""
        if tables := self.query(DataTable):
            table = tables.first()
            header = tuple(str(column.label) for column in table.ordered_columns)
            cells = (table.get_row_at(k) for k in range(table.row_count))
            return TableRows(header, tuple(tuple(str(cell) for cell in row) for row in cells))
        charts = [plot.chart for plot in self.query(Plot)]
        return rows_of_charts(charts) if any(chart.series for chart in charts) else None

    def text(self) -> str:
        """Return the pane's content as text: its rows as CSV, or its lines."""
        rows = self.rows()
        if rows is not None:
            return rows.csv()
        said = [str(lines.render()) for lines in self.query(Lines) if lines.display]
        return "\n".join(line for line in said if line) + "\n"


class TextPane(Pane):
    """A pane of text that scrolls."""

    can_focus = False
    EMPTY: ClassVar[str] = "No manoeuvre has ended yet."
    """Text of the pane before it has any content."""

    def compose(self) -> ComposeResult:
        with VerticalScroll():
            yield HangingLines(self.EMPTY)

    def write(self, rows: Iterable[Labelled]) -> None:
        self.query_one(HangingLines).write_rows(rows)
