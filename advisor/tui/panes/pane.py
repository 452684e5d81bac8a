"""The base of all panes."""

from typing import ClassVar

from textual.containers import Vertical
from textual.widgets import DataTable

from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part
from advisor.tui.plot.widget import Plot
from advisor.tui.rows import TableRows, rows_of_charts


class Pane(Part, Vertical):
    """A framed part of a screen that can be focused, explained, shown a `View`, and copied as text."""

    TITLE: ClassVar[str] = ""
    SHORT: ClassVar[str] = ""
    """The title where all titles have to share 80 columns."""
    OF_SELECTED: ClassVar[bool] = False
    """Whether the pane shows the selected manoeuvre."""
    HELP = ""
    """Content and use of the pane, for the help key."""
    can_focus = True
    """Whether the pane takes the focus. A pane whose content takes the keys (a table, a scrolling text) does
    not."""

    def on_mount(self) -> None:
        """Write the title into the frame."""
        self.border_title = self.TITLE

    @property
    def wants_showing(self) -> bool:
        """Whether the pane is in sight. Only panes in sight are updated."""
        return bool(self.display)

    def subtitle(self, text: str) -> None:
        """Write into the lower edge of the frame. An equal text costs nothing."""
        if text != self.border_subtitle:
            self.border_subtitle = text

    def rows(self) -> TableRows | None:
        """Give the pane's content as a table: of its cells, else of its curves; None: it holds text only."""
        if tables := self.query(DataTable):
            table = tables.first()
            header = tuple(str(column.label) for column in table.ordered_columns)
            cells = (table.get_row_at(k) for k in range(table.row_count))
            return TableRows(header, tuple(tuple(str(cell) for cell in row) for row in cells))
        charts = [plot.chart for plot in self.query(Plot)]
        return rows_of_charts(charts) if any(chart.series for chart in charts) else None

    def text(self) -> str:
        """Give the pane's content as text: its rows as CSV, or its lines."""
        rows = self.rows()
        if rows is not None:
            return rows.csv()
        said = [str(lines.render()) for lines in self.query(Lines) if lines.display]
        return "\n".join(line for line in said if line) + "\n"
