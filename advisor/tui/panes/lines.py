"""Lines of plain text that are repainted only when they change."""

from math import nan

from textual.widgets import Static


class Lines(Static):
    """Text as it stands, without markup: what vehicles and people wrote may hold any bracket."""

    def __init__(self, text: str = "", *, id: str | None = None) -> None:
        super().__init__(text, id=id, markup=False)
        self._text = text

    def write(self, text: str) -> None:
        """Show another text; the same one costs nothing, one as high as before no new layout."""
        if text != self._text:
            higher = self._rows(text) != self._rows(self._text)
            self._text = text
            self.update(text, layout=higher)

    def _rows(self, text: str) -> float:
        """How many rows a text takes; NaN, unequal to everything, when it must be wrapped to tell."""
        height = self.styles.height
        if height is not None and not height.is_auto:
            return height.value
        lines = text.split("\n")
        return len(lines) if max(map(len, lines)) <= self.size.width else nan
