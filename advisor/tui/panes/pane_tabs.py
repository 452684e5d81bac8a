"""Which pane is shown, on terminals too small for all of them."""

from rich.text import Text
from textual.widgets import Static


class PaneTabs(Static):
    """The numbered names of the panes on one line, the chosen one marked with brackets."""

    def __init__(self, titles: list[str]) -> None:
        super().__init__()
        self._titles = titles

    def choose(self, number: int) -> None:
        """Mark one pane."""
        short = [title.replace(" and link", "") for title in self._titles]
        self.update(Text(" ".join(f"[{t}]" if k == number else t for k, t in enumerate(short, 1))))
