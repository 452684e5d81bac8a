"""State of the lateral half of a campaign at one moment, frozen, for screens, texts and documents."""

from dataclasses import dataclass

from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.oem.estimate import NoEstimate
from advisor.oem.lateral_estimate import LateralEstimate


@dataclass(frozen=True, slots=True)
class JudgedLateral:
    """One lateral manoeuvre, its estimate and the verdict on it."""

    maneuver: Maneuver
    estimate: LateralEstimate | NoEstimate
    verdict: ManeuverVerdict


@dataclass(frozen=True, slots=True)
class LateralState:
    """State of the lateral half of a campaign."""

    maneuvers: tuple[JudgedLateral, ...]
    flight_test: FlightTestVerdict
    model: LateralEstimate | None
    """Joint estimate: over the newest accepted manoeuvres in flight, over all of them after the end."""
    estimate_from: tuple[int, ...]
    """Numbers of the manoeuvres that ``model`` is made from."""


OF_ELEVATOR = frozenset({"no_maneuver", "no_elevator", "no_alpha"})
"""Codes of problems that concern the elevator's axis alone."""
