"""Panes of the parameters with their intervals, and of the flying qualities."""

from collections.abc import Iterable
from itertools import accumulate

from rich.text import Text
from textual.app import ComposeResult
from textual.events import Resize
from textual.widgets import DataTable

from advisor.aircraft.reference import PARAMETERS, SIDE_PARAMETERS
from advisor.report.facts.estimates import EstimatedParameter, of_all, of_one
from advisor.report.qualities import coefficients_of, qualities_of, quality_lines, side_quality_lines
from advisor.session.conducting import View
from advisor.tui.panes.courses import history_chart
from advisor.tui.panes.pane import Pane, TextPane
from advisor.tui.plot.painting import Plot
from advisor.words.quantities import maneuvers_said

_COLUMNS = (
    ("parameter", 11),
    ("joint ± 95 %", 18),
    ("alone ± 95 %", 18),
    ("simulator", 10),
    ("off by", 6),
)
"""Name and width of each column, including a space at the end. A fixed width keeps the columns in place. The
last columns are left out if they have no room, because a cut number would be wrong.
"""
_SCROLL_BAR = 1
_FIRST_SHOWN = ("M_alpha", "L_p")
"""Parameter of each axis that is selected at the start, because users ask for it most often."""


class ParametersPane(Pane):
    """Table of the joint estimate, and the history of the parameter under the cursor."""

    EITHER_AXIS = True
    TITLE = "3 Parameters"
    SHORT = "3Par"
    can_focus = False
    HELP = """\
# Parameters

*joint*: the joint estimate over the accepted manoeuvres; *alone*: the selected manoeuvre alone; both with
95 % intervals (1.96 σ, corrected for coloured residuals). *simulator*: the aircraft file's model; *off by*:
how many σ it lies from the joint estimate. A column without room is left out.

**up/down** chooses the parameter whose history is drawn: each manoeuvre's value with its interval, the
simulator's value as a dashed line. *not identifiable*: the input did not separate this parameter from the
others; the verdict pane says why.
"""

    _view: View | None = None
    _columns = 0
    _shown = _FIRST_SHOWN[0]

    def compose(self) -> ComposeResult:
        """Lay out the table above the history plot."""
        yield DataTable[Text](cursor_type="row", cell_padding=0)
        yield Plot(history_chart(None, _FIRST_SHOWN[0]))

    def on_resize(self, event: Resize) -> None:
        """Show as many columns as have room."""
        columns = _columns_in(self.size.width - _SCROLL_BAR)
        if columns == self._columns:
            return
        self._columns, self._parts = columns, ()
        table = self.query_one(DataTable)
        table.clear(columns=True)
        for name, width in _COLUMNS[:columns]:
            table.add_column(name, width=width)
        if self._view is not None:
            self.show(self._view)

    def show(self, view: View) -> None:
        """Fill the table again after an estimate has changed."""
        self._view = view
        if not self._columns or not self.changed(view.state.maneuvers, view.state.model, view.judged):
            return
        table = self.query_one(DataTable)
        names = PARAMETERS if view.elevator is None else SIDE_PARAMETERS
        if self._shown not in names:
            self._shown = next(name for name in _FIRST_SHOWN if name in names)
        with self.prevent(DataTable.RowHighlighted):
            table.clear()
            for name in names:
                joint = of_all(name, view.state, view.aircraft.model)
                alone = of_one(name, view.judged, view.aircraft.model)
                table.add_row(*(Text(cell) for cell in _cells(joint, alone)[: self._columns]), key=name)
            table.move_cursor(row=names.index(self._shown))
        self._draw_history(self._shown)

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Draw the history of the parameter under the cursor."""
        event.stop()
        if event.row_key.value is not None:
            self._shown = event.row_key.value
            self._draw_history(self._shown)

    def _draw_history(self, name: str) -> None:
        self.query_one(Plot).chart = history_chart(self._view, name)


def _cells(joint: EstimatedParameter, alone: EstimatedParameter) -> tuple[str, ...]:
    return (
        f"{joint.name} {joint.unit}".removesuffix(" 1"),
        *("not identifiable" if row.reason else row.cell for row in (joint, alone)),
        joint.prior_cell,
        "–" if joint.off_by is None else f"{joint.off_by:.1f} σ",
    )


def _columns_in(width: int) -> int:
    """Return the number of columns that have room; the columns of the names and of the model are always
    shown.
    """
    ends = accumulate(width for _, width in _COLUMNS)
    return max(sum(end <= width for end in ends), 2)


class Qualities(TextPane):
    """Flying qualities of the joint estimate and their levels, each with its 95 % interval."""

    EITHER_AXIS = True
    TITLE = "u Flying qualities"
    SHORT = "uFQ"
    EMPTY = "No manoeuvre is accepted yet; flying qualities come from the joint estimate."
    HELP = """\
# Flying qualities

From the joint estimate over the accepted manoeuvres of the axis that is shown, each with half its 95 %
interval (delta method), and the levels of MIL-F-8785C.

Pitch: natural frequency and damping of the short period, T_θ2, n/α and CAP. Static margin, neutral point
and coefficients need `reference` in the aircraft file. The air density and the speed that they are given
for stand below.

Roll and yaw: Dutch roll, roll and spiral. Where the aircraft file states the derivatives, the tests of
14 CFR Part 60 compare the two.
"""

    def show(self, view: View) -> None:
        """Write the flying qualities after the joint estimate has changed."""
        if not self.changed(view.state.model, view.elevator and view.state.lateral):
            return
        lines = [(" " * (len(line) - len(line.lstrip())), line.strip()) for line in _lines(view)]
        self.write(lines or [("", self.EMPTY)])
        estimated = view.state.estimate_from
        self.subtitle(f"from {maneuvers_said(estimated)}" if estimated else "")


def _lines(view: View) -> Iterable[str]:
    """Return the lines of the axis that is shown; none without a joint estimate."""
    side, reference = view.state.lateral, view.aircraft.reference
    if view.elevator is not None and side is not None:
        return side_quality_lines(side, view.aircraft)
    qualities = qualities_of(view.state, reference)
    return () if qualities is None else quality_lines(qualities, coefficients_of(view.state, reference))
