"""Warning across the whole screen of a loss at this moment."""

from advisor.session.view import View
from advisor.tui.panes.lines import Lines, Part


class Alarm(Part, Lines):
    """One line that is visible only while data are being lost, such as while the disk accepts none."""

    def show(self, view: View) -> None:
        """Write the line, and show it."""
        self.write(f"✗ {view.health.alarm}" if view.health.alarm else "")
        self.set_class(bool(view.health.alarm), "-on")
