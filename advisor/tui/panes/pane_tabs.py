"""Choice of the visible pane, on terminals too small for all panes."""

from collections.abc import Sequence

from rich.style import Style
from rich.text import Text
from textual.widgets import Static

from advisor.tui.panes.lines import Redrawn

_BRACKETS = 2


class PaneTabs(Redrawn, Static):
    """Numbered names of the panes on one line, with the visible pane in brackets. A click chooses a pane."""

    def __init__(self, titles: Sequence[str], short: Sequence[str]) -> None:
        super().__init__()
        self._titles, self._short = titles, short
        self._chosen = 0

    def choose(self, number: int) -> None:
        """Mark one pane."""
        self._chosen = number
        self._redraw()

    def _redraw(self) -> None:
        room = self.size.width - _BRACKETS
        titles = self._titles if len(" ".join(self._titles)) <= room else self._short
        line = Text()
        for k, title in enumerate(titles, 1):
            press = Style(meta={"@click": f"screen.choose({k})"})
            line.append(f"[{title}]" if k == self._chosen else title, press)
            line.append(" " if k < len(titles) else "")
        self.update(line, layout=False)
