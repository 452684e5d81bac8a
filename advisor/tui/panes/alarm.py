"""Warning across the whole screen while data are being lost."""

from advisor.session.view import View
from advisor.tui.panes.lines import Lines, Part


class Alarm(Part, Lines):
    """One line that is visible only while data are being lost, for example because the disk is full."""

    def show(self, view: View) -> None:
        """Write the warning, and show the line while there is a warning."""
        self.write(f"✗ {view.health.alarm}" if view.health.alarm else "")
        self.set_class(bool(view.health.alarm), "-on")
