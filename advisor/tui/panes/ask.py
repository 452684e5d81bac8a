"""A question with a one-line answer, at the foot of its screen."""

from collections.abc import Callable
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.widget import Widget
from textual.widgets import Input, Label


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
