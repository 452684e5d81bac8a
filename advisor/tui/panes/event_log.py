"""What happened, in order."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from advisor.tui.panes.lines import Lines
from advisor.tui.panes.pane import Pane
from advisor.tui.view import View

_KEPT = 200


class EventLog(Pane):
    """The newest notices, the last one at the bottom."""

    TITLE = "8 Log"
    SHORT = "8 Log"
    can_focus = False
    HELP = """\
# Log

Verdicts, marks, notes, changes by hand and what the link reported, newest at the bottom. **m** adds a
mark at this moment.
"""

    def compose(self) -> ComposeResult:
        """Text that scrolls and stays at its end."""
        with VerticalScroll():
            yield Lines("Nothing has happened yet.")

    def on_mount(self) -> None:
        """Nothing is shown yet."""
        super().on_mount()
        self._shown: tuple[str, ...] = ()

    def show(self, view: View) -> None:
        """Write the newest lines."""
        if view.log and view.log is not self._shown:
            self._shown = view.log
            self.query_one(Lines).write("\n".join(view.log[-_KEPT:]))
            self.query_one(VerticalScroll).scroll_end(animate=False)
