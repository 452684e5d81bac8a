"""A page of help over the screen."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Markdown


class Explain(ModalScreen[None]):
    """Shows Markdown; any of escape, q and ? closes it."""

    CSS_PATH = "../styles/explain.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape,q,question_mark", "dismiss", "Close")]

    def __init__(self, markdown: str) -> None:
        super().__init__()
        self._markdown = markdown

    def compose(self) -> ComposeResult:
        """Text that scrolls."""
        with VerticalScroll(id="help"):
            yield Markdown(self._markdown)
