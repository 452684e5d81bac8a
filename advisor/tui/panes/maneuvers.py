"""Pane with every manoeuvre, its verdict, and the result of every rule."""

from textwrap import shorten

from rich.text import Text
from textual.app import ComposeResult
from textual.events import Resize
from textual.message import Message
from textual.widgets import DataTable

from advisor.campaign.state import JudgedManeuver
from advisor.session.conducting import View
from advisor.tui.panes.last_verdict import symbol_and_word
from advisor.tui.panes.pane import Pane
from advisor.words.quantities import clock

Columns = tuple[tuple[str, int], ...]
"""Name and width of each column of the table. The widths do not depend on the rows, so that new content moves
no column."""

_FIRST: Columns = (("no.", 3), ("start", 7), ("input", 15))
_MIDDLE: tuple[Columns, ...] = ((("verdict", 10), ("csi", 3)), (("", 2), ("csi", 3)), (("", 2),))
"""Sets of columns between the input and the reason, the most detailed set first. The shortest set is the
symbol alone.
"""
_REASON = 13
"""Width of the reason, in characters: ``free response`` and ``turbulence +1`` are the longest reasons."""
_RULES = ("continuous", "separate", "information")


class Maneuvers(Pane):
    """Table of manoeuvres. All panes of one manoeuvre show the manoeuvre under the cursor."""

    TITLE = "1 Manoeuvres"
    SHORT = "1Man"
    EITHER_AXIS = True
    can_focus = False
    HELP = """\
# Manoeuvres

One row for each manoeuvre that was found. **up/down** selects the one that the verdict, fit and
parameter panes show; on the last row they follow the newest.

- **x** excludes the selected manoeuvre from every decision, or includes it again; the reason is recorded.
- **n** adds a note to it.

*start*: minutes:seconds since power-on. *csi*: what the rules **c**ontinuous, **s**eparate and
**i**nformation say of it. *reason*: the most important one in a word, and how many more there are; the
verdict pane has them in sentences, with the cost J (det R of Eq. 7) and each rule's limit.
"""

    class Selected(Message):
        """Another manoeuvre was selected. None selects the newest manoeuvre at any time."""

        def __init__(self, number: int | None) -> None:
            super().__init__()
            self.number = number

    _shown: tuple[JudgedManeuver, ...] | None = None
    _judged: JudgedManeuver | None = None
    _columns: Columns = ()

    def compose(self) -> ComposeResult:
        """Lay out one table."""
        yield DataTable(cursor_type="row", zebra_stripes=True, cell_padding=1)

    def on_mount(self) -> None:
        """Show why the table is empty."""
        self.subtitle("none yet: a row appears when a manoeuvre has ended")

    def on_resize(self, event: Resize) -> None:
        """Fit the columns into the available width without cutting a word."""
        table = self.query_one(DataTable)
        columns = _columns(table.size.width)
        if columns != self._columns:
            self._columns = columns
            table.clear(columns=True)
            for name, width in columns:
                table.add_column(name, width=width)
            self._fill()

    def show(self, view: View) -> None:
        """Fill the table again after a verdict has changed."""
        maneuvers = view.state.maneuvers
        if maneuvers is self._shown or (not maneuvers and not self._shown):
            return
        self._shown, self._judged = maneuvers, view.judged
        self._fill()
        taken_out = sum(j.excluded_because is not None for j in maneuvers)
        self.subtitle(f"{len(maneuvers)} flown" + (f", {taken_out} excluded" if taken_out else ""))

    def _fill(self) -> None:
        """Write every row, in the widths of the columns."""
        table, shown = self.query_one(DataTable), self._shown or ()
        if not self._columns:
            return
        with self.prevent(DataTable.RowHighlighted):
            table.clear()
            for judged in shown:
                cells = [Text(_cell(judged, name, width)) for name, width in self._columns]
                table.add_row(*cells, key=str(judged.maneuver.number))
            if self._judged is not None:
                table.move_cursor(row=shown.index(self._judged), scroll=True)

    def on_data_table_row_highlighted(self, event: DataTable.RowHighlighted) -> None:
        """Report the manoeuvre under the cursor to the screen."""
        event.stop()
        if self._shown and event.row_key.value is not None:
            number = int(event.row_key.value)
            newest = number == self._shown[-1].maneuver.number
            self.post_message(self.Selected(None if newest else number))


def _columns(room: int) -> Columns:
    """Return the columns for a table of ``room`` characters, including its scroll bar."""
    columns: Columns = ()
    for middle in _MIDDLE:
        columns = (*_FIRST, *middle)
        rest = room - 1 - sum(width + 2 for _, width in columns) - 2
        if rest >= _REASON:
            break
    return (*columns, ("reason", max(rest, _REASON)))


def _cell(judged: JudgedManeuver, column: str, width: int) -> str:
    symbol, word = symbol_and_word(judged)
    match column:
        case "no.":
            return str(judged.maneuver.number)
        case "start":
            return clock(judged.maneuver.span.start_s)
        case "input":
            return judged.maneuver.span.kind
        case "verdict":
            return f"{symbol} {word}"
        case "csi":
            said = (judged.verdict.rules.get(rule) for rule in _RULES)
            return "".join("-" if rule is None else "✓" if rule.accepted else "✗" for rule in said)
        case "reason":
            return _reason(judged, width)
    return symbol


def _reason(judged: JudgedManeuver, width: int) -> str:
    """Return as many reasons against a manoeuvre as have room. No word is cut."""
    if judged.excluded_because is not None:
        return shorten(judged.excluded_because, width, placeholder="…")
    words = [r.code.replace("_", " ") for r in judged.verdict.reasons]
    listings = (_listed(words, count) for count in range(len(words), 0, -1))
    return next((listed for listed in listings if len(listed) <= width), words[0] if words else "")


def _listed(words: list[str], count: int) -> str:
    """Join the first words, and add the number of words left out."""
    more = f" +{len(words) - count}" if count < len(words) else ""
    return f"{', '.join(words[:count])}{more}"
