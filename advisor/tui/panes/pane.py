"""The base of all panes."""

from collections.abc import Iterable
from typing import ClassVar

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import DataTable

from advisor.tui.panes.lines import HangingLines, Labelled, Lines, Part
from advisor.tui.plot.widget import Plot
from advisor.tui.table_rows import TableRows, rows_of_charts


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
