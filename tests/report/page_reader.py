"""Reads what a page says: tables by their anchor, text without markup."""

from dataclasses import dataclass, field
from html.parser import HTMLParser


@dataclass
class Page(HTMLParser):
    """Tables and attributes of a page, read by the standard library's parser."""

    tables: dict[str, list[list[str]]] = field(default_factory=dict)
    """Anchor to rows of cells, the first row names the columns."""
    tags: set[str] = field(default_factory=set)
    attributes: list[tuple[str, str, str]] = field(default_factory=list)
    """Tag, attribute, value."""
    text: str = ""
    paragraphs: list[str] = field(default_factory=list)
    """Text of each paragraph."""

    def __post_init__(self) -> None:
        super().__init__()
        self._table = ""
        self._cell: list[str] | None = None
        self._in_paragraph = False

    @classmethod
    def read(cls, html: str) -> "Page":
        page = cls()
        page.feed(html)
        page.close()
        return page

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.add(tag)
        self.attributes += [(tag, name, value or "") for name, value in attrs]
        if tag == "table":
            self._table = dict(attrs)["id"] or ""
            self.tables[self._table] = []
        elif tag == "tr":
            self.tables[self._table].append([])
        elif tag in ("td", "th"):
            self._cell = []
        elif tag == "p":
            self.paragraphs.append("")
            self._in_paragraph = True

    def handle_endtag(self, tag: str) -> None:
        if tag in ("td", "th") and self._cell is not None:
            self.tables[self._table][-1].append("".join(self._cell))
            self._cell = None
        elif tag == "p":
            self._in_paragraph = False

    def handle_data(self, data: str) -> None:
        self.text += data
        if self._in_paragraph:
            self.paragraphs[-1] += data
        if self._cell is not None:
            self._cell.append(data)


def with_interval(cell: str) -> tuple[float, float]:
    """Value and half width of a cell such as ``−8.06 ± 0.35``."""
    value, half = (float(part.replace("−", "-")) for part in cell.split("±"))
    return value, half
