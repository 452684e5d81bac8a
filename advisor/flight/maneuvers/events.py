"""Events of the message stream for the flight test, in the order in which they became known."""

from dataclasses import dataclass, replace
from math import nan

from advisor.flight.maneuvers.maneuver import InputKind, Maneuver
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.words.ascii_output import printable
from advisor.words.axes import AxisName
from advisor.words.problems import Problem

_SOON_S = 30.0
"""Largest time between similar movements that are listed as one entry, s. Crews do not read a list of single
corrections."""


READER_NOTICE = "log_reader"
"""Code of a notice with a log reader's sentence, or about a parameter received in flight."""


@dataclass(frozen=True, slots=True)
class VehicleFound:
    """The followed vehicle has sent its first heartbeat."""

    vehicle: Vehicle


@dataclass(frozen=True, slots=True)
class Rebooted:
    """The vehicle's clock has restarted, so another power-on begins."""

    boot: int


@dataclass(frozen=True, slots=True)
class ModeChanged:
    """The autopilot has changed its flight mode."""

    mode: str
    at_s: float
    """Vehicle time of the mode change, s. NaN before the first stamped message."""


@dataclass(frozen=True, slots=True)
class ManeuverStarted:
    """A test input has been recognised, and its free response is being recorded."""

    at_s: float
    """Onset of the input's first step, s since boot."""
    kind: InputKind


@dataclass(frozen=True, slots=True)
class ManeuverFlown:
    """A manoeuvre is complete, with its data."""

    maneuver: Maneuver


@dataclass(frozen=True, slots=True)
class SideManeuverFlown:
    """A lateral manoeuvre is complete, with its data."""

    maneuver: Maneuver


@dataclass(frozen=True, slots=True)
class ManeuverAgain:
    """A known manoeuvre was recorded again, in another log or power-on. Each manoeuvre is used once."""

    maneuver: Maneuver
    """New record of the manoeuvre, with the known number."""
    takes_place: bool
    """Whether the new record has more samples than the known one, and replaces it."""
    axis: AxisName = "pitch"


@dataclass(frozen=True, slots=True)
class FlightBegan:
    """Another log or link of the campaign begins."""

    flight: int
    """Number of the log or link, 0 for the first."""
    name: str


@dataclass(frozen=True, slots=True)
class Activity:
    """A movement of the elevator that is no test input."""

    start_s: float
    """Begin of the movement, s since boot."""
    end_s: float
    reason: str
    """``aborted``, ``autopilot``, ``bounce``, ``elsewhere``, ``feedback``, ``ground``, ``hover``,
    ``no_information``, ``small``, ``undecided`` or ``unsettled``."""
    text: str
    """Sentence about the movement, for people."""
    stay_s: float
    """Begin of the vehicle's present stay in its flight mode, s since boot."""
    boot: int = 0
    """Number of the vehicle's power-on."""
    flight: int = 0
    """Number of the campaign's log or link, 0 for the first."""

    def joined(self, earlier: "Activity") -> "Activity | None":
        """Return one activity that joins this one and the earlier one; None if reason, boot or
        mode differ.
        """
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
    """Sentence for the event log."""

    code: str
    text: str

    def __post_init__(self) -> None:
        # Some of these sentences hold texts from a vehicle.
        object.__setattr__(self, "text", printable(self.text))


@dataclass(frozen=True, slots=True)
class VehicleSaid:
    """A vehicle, or another sender on the link, has sent a text (STATUSTEXT)."""

    text: str
    """Printable text on one line, of bounded length."""
    severity: str
    """Name of MAV_SEVERITY; empty where a log does not keep the severity."""
    system: int
    component: int
    at_s: float
    """Vehicle time, s since boot; NaN before the first stamped message."""


@dataclass(frozen=True, slots=True)
class NoData:
    """The present data cannot be used for an estimate."""

    problems: tuple[Problem, ...]
    """At least one problem, such as a missing or slow message, most fundamental first."""
    at_s: float = nan
    """Vehicle time, s since boot; NaN before the first stamped message."""


@dataclass(frozen=True, slots=True)
class DataAgain:
    """The present data can be used again."""

    at_s: float = nan
    """Vehicle time, s since boot; NaN before the first stamped message."""


FlightEvent = (
    VehicleFound
    | FlightBegan
    | Rebooted
    | ModeChanged
    | ManeuverStarted
    | ManeuverFlown
    | SideManeuverFlown
    | ManeuverAgain
    | Activity
    | Notice
    | VehicleSaid
    | NoData
    | DataAgain
)
