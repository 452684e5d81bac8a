"""What both faces have in common."""

from textual.message import Message
from textual.screen import Screen

from advisor.tui.hand import HandDecision
from advisor.tui.view import View


class Face(Screen[None]):
    """A screen that is shown a `View` whenever there is a new one."""

    class Decided(Message):
        """Someone decided something by hand."""

        def __init__(self, decision: HandDecision) -> None:
            super().__init__()
            self.decision = decision

    def show(self, view: View) -> None:
        """Update every part to a new moment."""
        raise NotImplementedError
