"""Every manoeuvre with its verdict, and what each rule would have said."""

from rich.text import Text
from textual.app import ComposeResult
from textual.message import Message
from textual.widgets import DataTable

from advisor.campaign.state import JudgedManeuver
from advisor.oem.estimate import Estimate
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.pane import Pane
from advisor.tui.view import View
from advisor.tui.words import clock

# Name and width: what grows must not push the others about.
_COLUMNS = (
    ("no.", 3),
    ("start", 5),
    ("input", 15),
    ("verdict", 10),
    ("con", 3),
    ("sep", 3),
    ("inf", 3),
    ("cost J", 8),
    ("reason", 30),
)
_RULES = ("continuous", "separate", "information")


class Maneuvers(Pane):
    """The table of manoeuvres; the row under the cursor is what the other panes show."""

    TITLE = "1 Manoeuvres"
    SHORT = "1 Man"
    can_focus = False
    HELP = """\
# Manoeuvres

One row for each manoeuvre that was found. **up/down** selects the one that the verdict, fit and
parameter panes show; on the last row they follow the newest.

- **x** takes the selected manoeuvre out of every decision, or in again; the reason is asked and recorded.
- **n** adds a note to it.

*con*, *sep*, *inf*: what the rules continuous, separate and information say of it; the cost J is det R
of Eq. (7).
"""

    class Selected(Message):
        """Another manoeuvre was chosen; None: follow the newest."""

        def __init__(self, number: int | None) -> None:
            super().__init__()
            self.number = number

    def compose(self) -> ComposeResult:
        """One table."""
        table: DataTable[Text] = DataTable(cursor_type="row", zebra_stripes=True, cell_padding=1)
        for name, width in _COLUMNS:
            table.add_column(name, width=width)
        yield table

    def on_mount(self) -> None:
        """Say why the table is empty."""
        super().on_mount()
        self._shown: tuple[JudgedManeuver, ...] | None = None
        self.subtitle("none yet: a row appears when a manoeuvre has ended")

    def show(self, view: View) -> None:
        """Fill the table anew when a verdict changed."""
        maneuvers = view.state.maneuvers
        if maneuvers is self._shown or (not maneuvers and not self._shown):
            return
        self._shown = maneuvers
        table = self.query_one(DataTable)
        with self.prevent(DataTable.RowHighlighted):
            table.clear()
            for judged in maneuvers:
                table.add_row(*(Text(cell) for cell in _cells(judged)), key=str(judged.maneuver.number))
            if view.judged is not None:
                table.move_cursor(row=maneuvers.index(view.judged), scroll=True)
        taken_out = sum(j.excluded_because is not None for j in maneuvers)
        self.subtitle(f"{len(maneuvers)} flown" + (f", {taken_out} excluded" if taken_out else ""))

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Tell the screen which manoeuvre the engineer looks at."""
        event.stop()
        if self._shown and event.row_key.value is not None:
            number = int(event.row_key.value)
            newest = number == self._shown[-1].maneuver.number
            self.post_message(self.Selected(None if newest else number))


def _cells(judged: JudgedManeuver) -> tuple[str, ...]:
    symbol, word = symbol_and_word(judged)
    maneuver, verdict = judged.maneuver, judged.verdict
    cost = f"{judged.estimate.cost:.2e}" if isinstance(judged.estimate, Estimate) else "-"
    rules = (verdict.rules.get(rule) for rule in _RULES)
    reason = judged.excluded_because or "; ".join(r.code for r in verdict.reasons)
    return (
        str(maneuver.number),
        clock(maneuver.span.start_s),
        maneuver.span.kind,
        f"{symbol} {word}",
        *("-" if rule is None else "✓" if rule.accepted else "✗" for rule in rules),
        cost,
        reason,
    )
