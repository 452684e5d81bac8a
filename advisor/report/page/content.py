"""Data of a page: the campaign at its end, its documents, and the origin of the data."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.field_sums import FieldSum
from advisor.analysis.vibration import Vibration
from advisor.campaign.state import CampaignState
from advisor.flight.signals.power_on import PowerOn

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
