"""Data of a page, and its parts in any format: sections of paragraphs, lists, tables and figures."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import wraps
from typing import Any, Literal

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.vibration import FieldSum, Vibration
from advisor.campaign.state import CampaignState
from advisor.flight.signals.track import PowerOn
from advisor.report.text import Table

Document = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a page's data."""

    files: Mapping[str, str]
    """SHA-256 of each input file, by its given name, logs first."""
    versions: Mapping[str, str]
    """Version of each program or library, by its name."""
    command: str
    """Command line that repeats the page."""


@dataclass(frozen=True, slots=True)
class Content:
    """All data of a page."""

    state: CampaignState
    """Campaign at its end, as the source of the curves."""
    analysis: Document
    """Document ``advisor.analyze/1``, as the source of the numbers."""
    names: tuple[str, ...]
    """Name of each log, flight by flight."""
    aircraft: Aircraft
    power_ons: tuple[tuple[int, PowerOn], ...]
    """Every power-on with all data, and the number of its flight, 0 for the first."""
    doctor: tuple[Document, ...]
    """Document ``advisor.doctor/1`` of each log."""
    gap: Document | None
    """Document ``advisor.gap/1``; None unless requested."""
    origin: Origin
    begun: tuple[str, ...] = ()
    """Date and time at which each log began."""
    vibration: tuple[Vibration | None, ...] = ()
    """Vibration of each log; None for an unreadable log."""
    fields: tuple[tuple[FieldSum, ...], ...] = ()
    """Fields of each log that were asked for by name."""


@dataclass(frozen=True, slots=True)
class Paragraph:
    """One or more sentences."""

    text: str
    kind: Literal["plain", "verdict", "note"] = "plain"


@dataclass(frozen=True, slots=True)
class Listing:
    """List of sentences, one for each item."""

    items: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Figure:
    """A picture with its caption."""

    svg: Callable[[], str]
    """Function that draws the picture, for formats that show one."""
    caption: str
    """Description of the picture, also for readers who cannot see it."""
    size: Literal["wide", "half", "third", "quarter", "sixth"] = "wide"
    narrow: Callable[[], str] | None = None
    """Function that draws the picture for a phone, where the broad one would be unreadable."""
    layers: tuple[str, ...] = ()
    """Channels that the reader can show over the picture, one at a time."""


@dataclass(frozen=True, slots=True)
class Gallery:
    """Figures that are placed side by side if there is room."""

    figures: tuple[Figure, ...]


@dataclass(frozen=True, slots=True)
class Verbatim:
    """Text for literal copying."""

    text: str


Block = Paragraph | Listing | Table | Gallery | Verbatim


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the page under one heading."""

    name: str
    """Anchor of the section within the page."""
    title: str
    blocks: tuple[Block, ...]


Part = Callable[[Content], Section | None]
"""Function that makes a section of the page; None without blocks."""


def section(name: str, title: str) -> Callable[[Callable[[Content], Iterator[Block]]], Part]:
    """Turn a function that yields the blocks of a section into one that returns the section."""

    def made(blocks: Callable[[Content], Iterator[Block]]) -> Part:
        @wraps(blocks)
        def part(content: Content) -> Section | None:
            made_blocks = tuple(blocks(content))
            return Section(name, title, made_blocks) if made_blocks else None

        return part

    return made


def listing(items: Sequence[str]) -> tuple[Listing, ...]:
    """Return a list, or nothing without items."""
    return (Listing(tuple(items)),) if items else ()
