"""What both faces have in common."""

from collections.abc import Callable
from contextlib import suppress

from textual.css.query import NoMatches
from textual.message import Message
from textual.screen import Screen

from advisor.tui.hand import HandDecision
from advisor.tui.panes.ask import Ask
from advisor.tui.panes.part import Part
from advisor.tui.view import View


class Face(Screen[None]):
    """A screen that is shown a `View` whenever there is a new one."""

    class Decided(Message):
        """Someone decided something by hand."""

        def __init__(self, decision: HandDecision) -> None:
            super().__init__()
            self.decision = decision

    def ask(self, question: str, answered: Callable[[str], object], *, integer: bool = False) -> None:
        """Ask for one line at the foot of the screen; a question still open is replaced."""
        self.query(Ask).remove()
        self.mount(Ask(question, answered, integer=integer))

    def show(self, view: View) -> None:
        """Update every part that wants to be to a new moment."""
        # A report may still arrive while the screen is taken down, its innermost widgets first.
        with suppress(NoMatches):
            for node in self.walk_children():
                if isinstance(node, Part) and node.wants_showing:
                    node.show(view)
