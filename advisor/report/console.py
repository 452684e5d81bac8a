"""Console for tables and screens of text."""

from typing import Any

from rich.console import Console
from rich.text import Text

from advisor.words.ascii_output import plain


class PlainConsole(Console):
    """Console on standard output that shows text literally, as names in files and vehicles may have brackets.

    Without Unicode, cells are spelled in ASCII before their widths are measured, so that columns stay
    aligned.

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
