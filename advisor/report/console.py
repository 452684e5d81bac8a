"""The console that tables and screens of text are printed on."""

from typing import Any

from rich.console import Console
from rich.text import Text

from advisor.ascii_output import plain


class PlainConsole(Console):
    """Standard output: text as it stands, for what files and vehicles call themselves may hold any bracket.

    Where the encoding is none of Unicode's, cells are spelled in ASCII before their widths are taken, so that
    columns stay straight.

    Parameters
    ----------
    soft_wrap
        Whether long lines are left to the terminal to wrap.
    """

    def __init__(self, soft_wrap: bool = False) -> None:
        super().__init__(highlight=False, markup=False, emoji=False, soft_wrap=soft_wrap)

    def render_str(self, text: str, **options: Any) -> Text:
        """Make text of a cell or a line given as a string."""
        return super().render_str(plain(text) if self.options.ascii_only else text, **options)
