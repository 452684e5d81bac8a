"""Help texts as pages: headings, paragraphs, lists, and words in bold, italic or as keys."""

import re

from rich.style import Style
from rich.text import Text

_BLOCKS = re.compile(r"\n\s*\n|\n(?=- )")
_MARKED = re.compile(r"\*\*(?P<bold>.+?)\*\*|\*(?P<italic>.+?)\*|`(?P<code>.+?)`")
_STYLES = {"bold": Style(bold=True), "italic": Style(italic=True), "code": Style(bold=True)}
_HEADING = Style(bold=True, underline=True)


def help_page(text: str) -> Text:
    """Return a help text, in a small part of Markdown, as one text that wraps to any width.

    Textual's own Markdown mounts a widget for every paragraph and cell, which takes a third of a second for a
    page.
    """
    page = Text()
    for block in _BLOCKS.split(text.strip()):
        line = " ".join(block.split())
        if line.startswith("# "):
            page.append(f"{line[2:]}\n\n", _HEADING)
        elif line.startswith("- "):
            page.append("• ")
            _append_marked(page, f"{line[2:]}\n")
        else:
            _append_marked(page, f"{line}\n\n")
    return page


def _append_marked(page: Text, line: str) -> None:
    end = 0
    for mark in _MARKED.finditer(line):
        page.append(line[end : mark.start()])
        kind = str(mark.lastgroup)
        page.append(mark[kind], _STYLES[kind])
        end = mark.end()
    page.append(line[end:])
