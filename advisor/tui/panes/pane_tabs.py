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
        names = [f"[{t}]" if k == number else f" {t} " for k, t in enumerate(self._titles, 1)]
        short = [name.replace(" and link", "") for name in names]
        self.update(Text("".join(short)))
