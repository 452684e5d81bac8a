"""What the stream of messages tells the flight test, in the order in which it became known."""

from dataclasses import dataclass, replace
from math import nan

from advisor.flight.maneuver import InputKind, Maneuver
from advisor.flight.vehicle import Vehicle
from advisor.printable import printable
from advisor.problems import Problem

_SOON_S = 30.0
"""Alike movements at most this far apart, s, are listed as one: a list of single corrections is not read."""


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
class ManeuverAgain:
    """A manoeuvre that is known already came in another log or power-on: it counts once."""

    maneuver: Maneuver
    """The record that came now, numbered as the one known."""
    takes_place: bool
    """Whether it holds more samples than the record known, and counts in its place."""


@dataclass(frozen=True, slots=True)
class FlightBegan:
    """Another log or link of the campaign begins."""

    flight: int
    """0 for the first."""
    name: str


@dataclass(frozen=True, slots=True)
class Activity:
    """The elevator moved, and it was no test input."""

    start_s: float
    """s since boot."""
    end_s: float
    reason: str
    """``autopilot``, ``ground``, ``hover``, ``small``, ``no_information`` or ``unsettled``."""
    text: str
    """A sentence for people."""
    stay_s: float
    """Since when the vehicle had been in its flight mode, s since boot; it tells one stay from the next."""
    boot: int = 0
    """Which power-on of the vehicle."""
    flight: int = 0
    """Which log or link of the campaign, 0 for the first."""

    def joined(self, earlier: "Activity") -> "Activity | None":
        """Return one activity for this and the one before; None where reason, boot or mode differ."""
        stay = (self.reason, self.flight, self.boot, self.stay_s)
        if stay != (earlier.reason, earlier.flight, earlier.boot, earlier.stay_s):
            return None
        if self.reason != "autopilot" and (
            self.text != earlier.text or self.start_s > earlier.end_s + _SOON_S
        ):
            return None
        return replace(earlier, end_s=max(self.end_s, earlier.end_s))


@dataclass(frozen=True, slots=True)
class Notice:
    """A sentence for the event log."""

    code: str
    text: str

    def __post_init__(self) -> None:
        # What a vehicle says stands in some of these sentences.
        object.__setattr__(self, "text", printable(self.text))


@dataclass(frozen=True, slots=True)
class VehicleSaid:
    """A vehicle, or another sender on the link, said something in words (STATUSTEXT)."""

    text: str
    """Printable, on one line, of bounded length."""
    severity: str
    """Name of MAV_SEVERITY; empty where a log does not keep the severity."""
    system: int
    component: int
    at_s: float
    """Vehicle time, s since boot; NaN before the first stamped message."""


@dataclass(frozen=True, slots=True)
class NoData:
    """What arrives at present cannot serve."""

    problems: tuple[Problem, ...]
    """Everything that is missing or too slow, the most fundamental first; at least one."""
    at_s: float = nan
    """Vehicle time, s since boot; NaN before the first stamped message."""


@dataclass(frozen=True, slots=True)
class DataAgain:
    """What arrives can serve again."""

    at_s: float = nan
    """Vehicle time, s since boot."""


FlightEvent = (
    VehicleFound
    | FlightBegan
    | Rebooted
    | ModeChanged
    | ManeuverStarted
    | ManeuverFlown
    | ManeuverAgain
    | Activity
    | Notice
    | VehicleSaid
    | NoData
    | DataAgain
)
