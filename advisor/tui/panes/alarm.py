"""What is being lost at this moment, across the whole screen."""

from advisor.tui.panes.lines import Lines
from advisor.tui.panes.part import Part
from advisor.tui.view import View


class Alarm(Part, Lines):
    """One line that is there only while something is lost, for example while the disk takes no recording."""

    def show(self, view: View) -> None:
        """Write the line, and show it."""
        self.write(f"✗ {view.health.alarm}" if view.health.alarm else "")
        self.set_class(bool(view.health.alarm), "-on")
