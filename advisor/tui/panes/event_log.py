"""The event log: sentences in order of time."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from advisor.session.view import View
from advisor.tui.panes.hanging import HangingLines
from advisor.tui.panes.pane import Pane

_SHOWN = 200
_TIME = 9
"""Number of characters before a sentence: its time and two blanks."""


class EventLogPane(Pane):
    """The newest notices, the last one at the bottom."""

    TITLE = "8 Log"
    SHORT = "8 Log"
    can_focus = False
    HELP = """\
# Log

Verdicts, marks, notes, changes by hand, what the vehicle said in words (STATUSTEXT, with its severity, and
its sender where that is not the vehicle) and what the link reported, newest at the bottom. **m** adds a mark
at this moment.

Times are minutes:seconds since the vehicle's boot, as in the table of manoeuvres and in the replay bar. They
begin anew where a line says that another power-on, flight or vehicle begins.
"""

    def compose(self) -> ComposeResult:
        """Yield a text that scrolls and stays at its end."""
        with VerticalScroll():
            yield HangingLines("Nothing has happened yet.")

    def on_mount(self) -> None:
        """Show nothing yet, and the newest line whenever there is one."""
        super().on_mount()
        self._shown: tuple[str, ...] = ()
        self.query_one(VerticalScroll).anchor()

    def show(self, view: View) -> None:
        """Write the newest lines."""
        if view.log and view.log is not self._shown:
            self._shown = view.log
            self.query_one(HangingLines).write_rows(
                (line[:_TIME], line[_TIME:]) for line in view.log[-_SHOWN:]
            )
