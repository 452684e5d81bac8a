"""The base class of both screens, and a question with a one-line answer."""

from collections.abc import Callable
from contextlib import suppress
from functools import partial
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.css.query import NoMatches
from textual.events import Event, ScreenResume
from textual.message import Message
from textual.screen import Screen
from textual.widget import Widget
from textual.widgets import Input, Label

from advisor.campaign.hand_decisions import HandDecision
from advisor.process.parts import Parts
from advisor.session.view import View
from advisor.tui.panes.lines import Part
from advisor.tui.panes.status_line import KeysLine


class Ask(Horizontal):
    """Asks for a reason, a note or a number. The Escape key leaves everything unchanged.

    The question is a line and not a dialog, so that the subject of the question stays visible.
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", "Leave it")]

    def __init__(self) -> None:
        super().__init__()
        self._answered: Callable[[str], object] = lambda answer: None
        self._focused_before: Widget | None = None

    def compose(self) -> ComposeResult:
        """Yield the question and the answer, side by side."""
        yield Label(markup=False)
        yield Input(compact=True)

    def put(self, question: str, answered: Callable[[str], object], *, integer: bool = False) -> None:
        """Show a question and take the focus. A question that is still open is replaced.

        Parameters
        ----------
        integer : bool
            Whether the answer must be a whole number.
        """
        if not self.has_class("-open"):
            self._focused_before = self.screen.focused
        self._answered = answered
        self.query_one(Label).update(question)
        answer = self.query_one(Input)
        answer.type = "integer" if integer else "text"
        answer.value = ""
        self.add_class("-open")
        answer.focus()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Send the answer to the function that waits for it."""
        event.stop()
        answer = event.value.strip()
        if answer and (event.validation_result is None or event.validation_result.is_valid):
            self.action_leave()
            self._answered(answer)

    def action_leave(self) -> None:
        """Close the question, and return the keys to the screen."""
        self.screen.set_focus(self._focused_before)
        self.remove_class("-open")


class Face(Screen[None]):
    """A screen that receives every new `View`."""

    AUTO_FOCUS = ""

    class Decided(Message):
        """A crew member has excluded, included or noted on a manoeuvre."""

        def __init__(self, decision: HandDecision) -> None:
            super().__init__()
            self.decision = decision

    def __init__(self) -> None:
        super().__init__()
        self._parts = Parts(lambda failed: self.notify(str(failed.problem), severity="error", markup=False))

    async def on_event(self, event: Event) -> None:
        """Resume a screen without new styles. The switch of screens already applies a theme that changed
        meanwhile.
        """
        if isinstance(event, ScreenResume):
            event.refresh_styles = False
        await super().on_event(event)

    def ask(self, question: str, answered: Callable[[str], object], *, integer: bool = False) -> None:
        """Ask for one line of text at the foot of the screen."""
        self.query_one(Ask).put(question, answered, integer=integer)

    def say(self, text: str, seconds: float = 3.0) -> None:
        """Show a text on the last line, for a while. A text without room there appears above the line."""
        line = self.query_one(KeysLine)
        if line.has_room_for(text):
            line.say(text, seconds)
        else:
            self.notify(text, timeout=seconds, markup=False)

    def show(self, view: View) -> None:
        """Show the state of a new moment in every visible part."""
        # A report may still arrive while the screen is taken down, its innermost widgets first.
        with suppress(NoMatches):
            for node in self.walk_children():
                if isinstance(node, Part) and node.wants_showing:
                    shown = view if node.EITHER_AXIS else view.elevator or view
                    name = f"pane {node.id or type(node).__name__}"
                    self._parts.make(name, partial(node.show, shown), lambda failed: None)
