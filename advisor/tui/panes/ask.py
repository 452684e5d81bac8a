"""A question with one line of answer, at the foot of the screen that it is about."""

from collections.abc import Callable
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Horizontal
from textual.widget import Widget
from textual.widgets import Input, Label


class Ask(Horizontal):
    """Asks for a reason, a note or a number; escape leaves everything as it is.

    It is a line and no dialog, so that what the question is about stays in sight.

    Parameters
    ----------
    question : str
        What is asked.
    answered : callable
        Receives the answer; an empty one is not taken.
    integer : bool
        Take whole numbers only.
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "leave", "Leave it")]

    def __init__(self, question: str, answered: Callable[[str], object], *, integer: bool = False) -> None:
        super().__init__()
        self._question = question
        self._answered = answered
        self._integer = integer
        self._focused_before: Widget | None = None

    def compose(self) -> ComposeResult:
        """Question beside answer."""
        yield Label(self._question, markup=False)
        yield Input(type="integer" if self._integer else "text", compact=True)

    def on_mount(self) -> None:
        """Take the keys until the answer is given."""
        self._focused_before = self.screen.focused
        self.query_one(Input).focus()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Hand the answer on."""
        event.stop()
        answer = event.value.strip()
        if answer and (event.validation_result is None or event.validation_result.is_valid):
            self.action_leave()
            self._answered(answer)

    def action_leave(self) -> None:
        """Give the keys back."""
        self.screen.set_focus(self._focused_before)
        self.remove()
