"""Lines of plain text that are repainted only when they change."""

from math import nan

from textual.widgets import Static


class Lines(Static):
    """Text without markup, because texts of vehicles and people may hold any bracket."""

    def __init__(self, text: str = "", *, id: str | None = None) -> None:
        super().__init__(text, id=id, markup=False)
        self._text = text

    def write(self, text: str) -> None:
        """Show another text. An equal text costs nothing, and one of equal height no new layout."""
        if text != self._text:
            higher = self._rows(text) != self._rows(self._text)
            self._text = text
            self.update(text, layout=higher)

    def _rows(self, text: str) -> float:
        """Return the number of rows of a text; NaN, unequal to everything, where the text must be wrapped
        first."""
        height = self.styles.height
        if height is not None and not height.is_auto:
            return height.value
        lines = text.split("\n")
        return len(lines) if max(map(len, lines)) <= self.size.width else nan
