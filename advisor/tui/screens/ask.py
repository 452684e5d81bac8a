"""A question with one line of answer."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Label


class Ask(ModalScreen[str | None]):
    """Asks for a reason, a note or a number; escape gives None, an empty answer is not taken.

    Parameters
    ----------
    question : str
        One sentence.
    integer : bool
        Take whole numbers only.
    """

    CSS_PATH = "../styles/dialogs.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "dismiss(None)", "Cancel")]

    def __init__(self, question: str, *, integer: bool = False) -> None:
        super().__init__()
        self._question = question
        self._integer = integer

    def compose(self) -> ComposeResult:
        """Question over answer."""
        with Vertical(id="dialog"):
            yield Label(self._question, markup=False)
            yield Input(type="integer" if self._integer else "text")
            yield Label("enter: yes   escape: leave it", id="hint")

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Give the answer back."""
        event.stop()
        answer = event.value.strip()
        if answer and (event.validation_result is None or event.validation_result.is_valid):
            self.dismiss(answer)
