"""Pane of the event log, whose sentences are in order of time."""

from textual.containers import VerticalScroll

from advisor.session.view import View
from advisor.tui.panes.pane import TextPane

_SHOWN = 200
_TIME = 9
"""Number of characters before a sentence, for the sentence's time and two blanks."""


class EventLogPane(TextPane):
    """Pane with the newest sentences of the event log, the last sentence at the bottom."""

    TITLE = "8 Log"
    SHORT = "8Log"
    EMPTY = "Nothing has happened yet."
    HELP = """\
# Log

Verdicts, marks, notes, changes by hand, what the vehicle said in words (STATUSTEXT, with its severity, and
its sender where that is not the vehicle) and what the link reported, newest at the bottom. **m** adds a mark
at this moment.

Times are minutes:seconds since power-on, as in the table of manoeuvres and in the replay bar. They
begin anew where a line says that another power-on, flight or vehicle begins.
"""

    def on_mount(self) -> None:
        """Keep the newest sentence visible."""
        self.query_one(VerticalScroll).anchor()

    def show(self, view: View) -> None:
        if view.log and self.changed(view.log):
            self.write((line[:_TIME], line[_TIME:]) for line in view.log[-_SHOWN:])
