"""What all panes have in common."""

from typing import ClassVar

from textual.containers import Vertical

from advisor.tui.view import View


class Pane(Vertical):
    """A framed part of a screen that can be focused, explained and shown a `View`."""

    TITLE: ClassVar[str] = ""
    HELP = ""
    """What the pane shows and how to use it, for the help key."""
    can_focus = True

    def on_mount(self) -> None:
        """Write the title into the frame."""
        self.border_title = self.TITLE

    def show(self, view: View) -> None:
        """Update to a new moment; cheap when nothing of the pane's own changed."""
        raise NotImplementedError
