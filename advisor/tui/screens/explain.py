"""A page of help over the screen."""

from typing import ClassVar

from rich.text import Text
from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Static


class Explain(ModalScreen[None]):
    """Shows a text. Each of the keys escape, q and ? closes the page."""

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape,q,question_mark", "dismiss", "Close")]

    def __init__(self, page: Text) -> None:
        super().__init__()
        self._page = page

    def compose(self) -> ComposeResult:
        """Yield the text in a scrolling container."""
        with VerticalScroll(id="help"):
            yield Static(self._page)
