"""What a campaign knows at one moment: everything a face may show, frozen."""

from collections.abc import Mapping
from dataclasses import dataclass

from advisor.decision.verdict import FlightTestVerdict, ManeuverVerdict
from advisor.flight.elevator_guess import Guess
from advisor.flight.events import Activity
from advisor.flight.flights import FlightHeard
from advisor.flight.maneuver import Maneuver
from advisor.flight.track import ChannelStatus
from advisor.flight.vehicle import Vehicle
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.problems import Problem


@dataclass(frozen=True, slots=True)
class JudgedManeuver:
    """One manoeuvre, its estimate and the verdict on it."""

    maneuver: Maneuver
    estimate: Estimate | NoEstimate
    verdict: ManeuverVerdict
    excluded_because: str | None = None
    """Set when an engineer took it out by hand."""
    notes: tuple[str, ...] = ()
    """What the engineer wrote beside it."""


@dataclass(frozen=True, slots=True)
class CampaignState:
    """Everything a face may show, as of the newest sample."""

    vehicle: Vehicle | None
    """None before the first heartbeat."""
    now_s: float
    """Vehicle time of the newest sample, seconds since boot."""
    duration_s: float
    """Vehicle time heard so far, over all power-ons, s."""
    mode: str
    channels: Mapping[str, ChannelStatus]
    maneuvers: tuple[JudgedManeuver, ...]
    flight_test: FlightTestVerdict
    model: Estimate | None
    """Joint estimate over the newest accepted manoeuvres; over all of them once the flight has ended."""
    flying: Maneuver | None = None
    """The manoeuvre being flown now, cut so far."""
    marking_since_s: float | None = None
    """When the mark began that a hand has still to end, s since boot."""
    settling: Estimate | None = None
    """Estimate from the manoeuvre being flown, refreshed as it goes."""
    enough: str | None = None
    """Set when further free response would add nothing: the pilot may recover."""
    estimate_from: tuple[int, ...] = ()
    """Numbers of the manoeuvres that ``model`` is made from."""
    elevator_notes: tuple[str, ...] = ()
    """What is assumed of the elevator's scale and sense, in sentences."""
    reader_notes: tuple[str, ...] = ()
    """What the reader of the log had to choose or to leave out, in sentences."""
    elevator_guess: Guess | None = None
    """Which output may be the elevator, while nothing says it."""
    other_vehicles: tuple[int, ...] = ()
    """System ids of further vehicles heard, rising."""
    no_data: tuple[Problem, ...] = ()
    """Why what arrives at present cannot serve; empty when it can."""
    mark_notes: tuple[str, ...] = ()
    """Marks that could not be used, each with its reason."""
    notices: tuple[str, ...] = ()
    """Sentences for the event log with the vehicle's time, the newest of them, oldest first."""
    flight: int = 0
    """Which log or link is being heard, 0 for the first."""
    boot: int = 0
    """Which power-on of the vehicle in this log or link, 0 for the first."""
    flights: tuple[FlightHeard, ...] = ()
    """Every log and link so far, the one being heard last."""
    activity: tuple[Activity, ...] = ()
    """Movements of the elevator that were no test inputs, oldest first; alike neighbours are one."""
