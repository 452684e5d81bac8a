"""What all panes have in common."""

from typing import ClassVar

from textual.containers import Vertical

from advisor.tui.panes.part import Part


class Pane(Part, Vertical):
    """A framed part of a screen that can be focused, explained and shown a `View`."""

    TITLE: ClassVar[str] = ""
    HELP = ""
    """What the pane shows and how to use it, for the help key."""
    can_focus = True
    """Unless something in it takes the keys: a table, a text that scrolls."""

    def on_mount(self) -> None:
        """Write the title into the frame."""
        self.border_title = self.TITLE

    @property
    def wants_showing(self) -> bool:
        """Only panes in sight are updated."""
        return bool(self.display)

    def subtitle(self, text: str) -> None:
        """Write into the lower edge of the frame; the same text costs nothing."""
        if text != self.border_subtitle:
            self.border_subtitle = text
