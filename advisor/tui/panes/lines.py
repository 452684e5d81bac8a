"""Lines of plain text that are repainted only when they change."""

from textual.widgets import Static


class Lines(Static):
    """Text as it stands, without markup: what vehicles and people wrote may hold any bracket."""

    def __init__(self, text: str = "", *, id: str | None = None) -> None:
        super().__init__(text, id=id, markup=False)
        self._text = text

    def write(self, text: str) -> None:
        """Show another text; the same one costs nothing."""
        if text != self._text:
            self._text = text
            self.update(text)
