"""What a page is made of: sections of paragraphs, lists, tables and figures, whatever the format."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal


@dataclass(frozen=True, slots=True)
class Paragraph:
    """One or more sentences."""

    text: str
    kind: Literal["plain", "verdict", "note"] = "plain"


@dataclass(frozen=True, slots=True)
class Listing:
    """Sentences, one an item."""

    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Table:
    """Cells as they are read; the first row names the columns."""

    name: str
    """Its anchor in the page."""
    caption: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    numbers: frozenset[int] = frozenset()
    """Columns that hold numbers, from 0."""


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture with its words."""

    svg: Callable[[], str]
    """Draws the picture, where the format shows one."""
    caption: str
    """What the picture shows, for those who cannot see it too."""
    size: Literal["wide", "half", "third", "quarter"] = "wide"
    narrow: Callable[[], str] | None = None
    """Draws the picture for a phone, where the broad one would be too small to read."""


@dataclass(frozen=True, slots=True)
class Gallery:
    """Figures that stand side by side where there is room."""

    figures: tuple[Figure, ...]


@dataclass(frozen=True, slots=True)
class Verbatim:
    """Text to be copied as it stands."""

    text: str


Block = Paragraph | Listing | Table | Gallery | Verbatim


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page under one heading."""

    name: str
    """Its anchor in the page."""
    title: str
    blocks: tuple[Block, ...]


def listing(items: Sequence[str]) -> tuple[Listing, ...]:
    """A list, or nothing where it would be empty."""
    return (Listing(tuple(items)),) if items else ()
