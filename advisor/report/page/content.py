"""Data of a page: the campaign at its end, its documents, and the origin of everything."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.state import CampaignState
from advisor.flight.signals.power_on import PowerOn

Document = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a page."""

    files: Mapping[str, str]
    """Given name of each input file to its SHA-256, logs first."""
    versions: Mapping[str, str]
    """Program or library to its version."""
    command: str
    """Command line that repeats the page."""


@dataclass(frozen=True, slots=True)
class Content:
    """All data of a page."""

    state: CampaignState
    """Campaign at its end, for the curves."""
    analysis: Document
    """``advisor.analyze/1``, for the numbers."""
    names: tuple[str, ...]
    """Name of each log, flight by flight."""
    aircraft: Aircraft
    power_ons: tuple[tuple[int, PowerOn], ...]
    """Every power-on, whole, with the number of its flight, 0 for the first."""
    doctor: tuple[Document, ...]
    """``advisor.doctor/1`` of each log."""
    gap: Document | None
    """``advisor.gap/1``, where requested."""
    origin: Origin
    begun: tuple[str, ...] = ()
    """Date and time at which each log began."""
