"""The base of all panes, and rows with a header."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from io import StringIO
from math import isfinite
from typing import ClassVar

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import DataTable

from advisor.tui.panes.lines import HangingLines, Labelled, Lines, Part
from advisor.tui.plot.chart import Chart
from advisor.tui.plot.widget import Plot

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
