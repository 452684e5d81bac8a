"""What the stream of messages tells the flight test, in the order in which it became known."""

from dataclasses import dataclass

from advisor.flight.maneuver import InputKind, Maneuver
from advisor.flight.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class VehicleFound:
    """The first heartbeat of the vehicle to be followed."""

    vehicle: Vehicle


@dataclass(frozen=True, slots=True)
class Rebooted:
    """The vehicle's clock began anew: another flight."""

    boot: int


@dataclass(frozen=True, slots=True)
class ModeChanged:
    """The autopilot is in another flight mode."""

    mode: str
    at_s: float
    """Vehicle time; NaN before the first stamped message."""


@dataclass(frozen=True, slots=True)
class ManeuverStarted:
    """A test input has been recognised; its free response is being recorded."""

    at_s: float
    """Onset of its first step, s since boot."""
    kind: InputKind


@dataclass(frozen=True, slots=True)
class ManeuverFlown:
    """A manoeuvre is complete, with its data."""

    maneuver: Maneuver


@dataclass(frozen=True, slots=True)
class Notice:
    """A sentence for the event log."""

    code: str
    text: str


FlightEvent = VehicleFound | Rebooted | ModeChanged | ManeuverStarted | ManeuverFlown | Notice
