"""What a page is written from: the campaign at its end, its documents, and where everything came from."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from advisor.aircraft import Aircraft
from advisor.campaign.state import CampaignState
from advisor.flight.power_on import PowerOn

Document = Mapping[str, Any]


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a page came from."""

    files: Mapping[str, str]
    """File as given to its SHA-256, logs first."""
    versions: Mapping[str, str]
    """Program or library to its version."""
    command: str
    """The command line that repeats the page."""


@dataclass(frozen=True, slots=True)
class Content:
    """Everything a page shows."""

    state: CampaignState
    """For the curves."""
    analysis: Document
    """``advisor.analyze/1``, for the numbers."""
    names: tuple[str, ...]
    """What each log is called, flight by flight."""
    aircraft: Aircraft
    power_ons: tuple[tuple[int, PowerOn], ...]
    """Every power-on, whole, with the number of its flight, 0 for the first."""
    doctor: tuple[Document, ...]
    """``advisor.doctor/1`` of each log."""
    gap: Document | None
    """``advisor.gap/1``, where it was asked for."""
    origin: Origin
