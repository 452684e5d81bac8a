"""Tables of results as text cells, for terminal and page, and the console that prints them."""

from dataclasses import dataclass
from typing import Any

from rich import table as console
from rich.console import Console
from rich.text import Text

from advisor.words.ascii_output import plain


@dataclass(frozen=True, slots=True)
class Table:
    """Table of text cells. The first row names the columns."""

    name: str
    """Anchor of the table within the page."""
    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: frozenset[int] = frozenset()
    """Indices of the columns with numbers, from 0."""
    anchored: bool = False
    """Whether each row has an anchor in the page. The anchor is the table's name, a hyphen and the row's
    first cell.
    """

    def on_console(self, title: str | None = None) -> console.Table:
        """Return the table for a terminal, without frame, under a title."""
        shown = console.Table(
            title=title,
            title_justify="left",
            title_style="bold",
            box=None,
            pad_edge=False,
            header_style="dim",
        )
        for k, name in enumerate(self.head):
            shown.add_column(name, justify="right" if k in self.numbers else "left", no_wrap=k == 0)
        for row in self.rows:
            shown.add_row(*row)
        return shown


def digits(value: float | None, count: int) -> str:
    """Return a number with ``count`` decimals; a dash for a missing or undefined one."""
    return "–" if value is None or value != value else f"{value:.{count}f}"


class PlainConsole(Console):
    """Console on standard output that shows text literally, because names may contain brackets.

    Without Unicode, cells become ASCII before their widths are measured, so that columns stay aligned.

    Parameters
    ----------
    soft_wrap
        Whether the terminal wraps long lines.
    """

    def __init__(self, soft_wrap: bool = False) -> None:
        super().__init__(highlight=False, markup=False, emoji=False, soft_wrap=soft_wrap)

    def render_str(self, text: str, **options: Any) -> Text:
        """Return the text of a cell or line given as a string."""
        return super().render_str(plain(text) if self.options.ascii_only else text, **options)
