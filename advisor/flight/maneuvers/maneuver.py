"""A manoeuvre: the stretch of flight for one estimate, the comparison of two records, and the events of a
flight.

Two records contain one manoeuvre if both show equal pitch angles at equal vehicle times. Even two simulated
flights of one schedule differ by more than a log's resolution.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from math import nan
from typing import Literal

import numpy as np

from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import Distrust, InstrumentFinding
from advisor.flight.vehicle.surfaces import Scale
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.process.arrays import FloatArray
from advisor.words.axes import AxisName
from advisor.words.problems import Problem, printable

BEFORE_S = 2.0
"""Length in s of the command before a record that is kept for the servo. Earlier commands no longer move
it."""

CONTROLS = ("elevator", "aileron", "rudder")

InputKind = Literal[
    "3-2-1-1",
    "reverse 3-2-1-1",
    "doublet",
    "pulse",
    "multisine",
    "other",
    "aileron doublet",
    "aileron 1-2-1",
    "bank to bank",
    "aileron 3-2-1-1",
    "rudder doublet",
    "rudder 3-2-1-1",
    "dutch roll release",
]
"""Names of inputs: those of the elevator, then those of aileron and rudder."""


@dataclass(frozen=True, slots=True)
class Span:
    """Extent of a manoeuvre in the elevator samples, as found by the segmenter."""

    record_from_s: float
    """First stamp of the record, s. The record begins with a lead-in before the first step."""
    start_s: float
    """Onset of the first elevator step, s."""
    last_step_s: float
    """Onset of the last elevator step (the return to trim), s."""
    end_s: float
    """End of the free response and last stamp of the record, s."""
    kind: InputKind
    steps: tuple[tuple[float, float], ...]
    """Steps of the input: (onset in s, level in rad from trim) for each."""
    closed_by: str
    """Reason for the end: ``quiet``, ``mode change``, ``next input``, ``gap``, ``end of log``, ``air speed``,
    ``no rest``. The reason of a marked stretch begins with ``marked``, such as ``marked by hand`` or ``marked
    by SystemID``. The reason of a movement that is being flown is ``still flying``."""

    @property
    def input_is_over(self) -> bool:
        """Whether the elevator has come to rest after its last step."""
        return self.last_step_s < self.end_s

    @property
    def is_test_input(self) -> bool:
        """Whether the movement is a test input: by the shape of a named input, or by a mark."""
        return self.kind != "other" or self.is_marked

    @property
    def is_marked(self) -> bool:
        """Whether a person or a message marked the movement as a manoeuvre."""
        return self.closed_by.startswith("marked")


@dataclass(frozen=True, slots=True)
class Maneuver:
    """A manoeuvre's extent with its data. ``channels`` contains at least ``elevator``, and each channel has
    its own stamps."""

    number: int
    boot: int
    """Number of the vehicle's power-on, 0 for the first in the log or link."""
    span: Span
    channels: Mapping[str, Channel]
    mode: str = ""
    """Flight mode of the manoeuvre, by the autopilot's name or number."""
    distrusts: tuple[Distrust, ...] = ()
    """Channels with impossible values. A frozen specific force or α is not in ``channels``."""
    findings: tuple[InstrumentFinding, ...] = ()
    """Contradictions of the instruments, from all records of this power-on so far. ``channels`` are corrected
    by the findings that are marked as used."""
    flight: int = 0
    """Number of the campaign's log or link, 0 for the first."""
    data_notes: tuple[str, ...] = ()
    """Sentences about samples that no aircraft can have flown, and about an air speed without a sensor."""
    missed_s: float = 0.0
    """Time within the record, or at its end, in which the advisor was down, s."""
    leapt_s: float = 0.0
    """Jump of the vehicle's stamps within the record or at its ends, s."""
    scale: Scale | None = None
    """Scale of the elevator's pulses, with the direction that was found. None for a calibrated elevator and
    for several outputs."""
    before: Mapping[str, Channel] = field(default_factory=dict)
    """Commands in the ``BEFORE_S`` before the record, by control. They still move a servo with a lag when the
    record begins."""

    @property
    def power_on(self) -> tuple[int, int]:
        """Numbers of the flight and of the power-on that contain the manoeuvre."""
        return self.flight, self.boot

    def later(self, by_s: float) -> "Maneuver":
        """Return the manoeuvre with ``by_s`` added to all times."""
        span = replace(
            self.span,
            record_from_s=self.span.record_from_s + by_s,
            start_s=self.span.start_s + by_s,
            last_step_s=self.span.last_step_s + by_s,
            end_s=self.span.end_s + by_s,
            steps=tuple((onset + by_s, level) for onset, level in self.span.steps),
        )
        channels, before = (
            {name: replace(c, t=c.t + by_s) for name, c in part.items()}
            for part in (self.channels, self.before)
        )
        return replace(self, span=span, channels=channels, before=before)

    def between(self, from_s: float, to_s: float) -> "Maneuver":
        """Return the manoeuvre with its samples between two vehicle times, s, which are within its record."""
        channels = {name: c.cut(from_s, to_s) for name, c in self.channels.items()}
        commands = {name: self.command(name) for name in CONTROLS if name in channels}
        before = {
            name: c.cut(from_s - BEFORE_S, np.nextafter(from_s, -np.inf)) for name, c in commands.items()
        }
        return replace(self, channels=channels, before={name: c for name, c in before.items() if len(c)})

    def command(self, control: str) -> Channel:
        """Return the command of a control, with its samples before the record."""
        channel, before = self.channels[control], self.before.get(control)
        if before is None:
            return channel
        return replace(channel, t=np.append(before.t, channel.t), y=np.append(before.y, channel.y))

    def deflected(self, by: Callable[[FloatArray], FloatArray]) -> "Maneuver":
        """Return the manoeuvre with ``by`` applied to all deflections of the elevator."""
        channels, before = (
            {name: replace(c, y=by(c.y)) if name == "elevator" else c for name, c in part.items()}
            for part in (self.channels, self.before)
        )
        return replace(self, channels=channels, before=before)


_AGREE_RAD = 3e-4
"""Largest median difference of pitch angle, rad, between two records of one manoeuvre. A log with a
resolution of 0.01 deg has differences of 1e-4 rad. Two simulated flights of one schedule with 1 % of noise
differ by 1.4e-3 rad."""
_SKEW_S = 0.01
"""Largest difference between the stamps of one attitude in two logs, s, due to sending or writing."""
_COMMON = 0.5
"""Least common time of two records of one manoeuvre, as a share of the shorter record."""
_FEWEST = 10
"""Least number of samples for a comparison of two records."""


def are_one(a: Maneuver, b: Maneuver) -> bool:
    """Return whether two records from different power-ons contain one manoeuvre."""
    from_s = max(a.span.start_s, b.span.start_s)
    to_s = min(a.span.end_s, b.span.end_s)
    shorter_s = min(m.span.end_s - m.span.start_s for m in (a, b))
    name = next((n for n in ("theta", "q") if n in a.channels and n in b.channels), None)
    if name is None or not to_s - from_s > _COMMON * shorter_s:
        return False
    reference, other = a.channels[name], b.channels[name].cut(from_s, to_s)
    within = (other.t >= reference.t[0]) & (other.t <= reference.t[-1])
    t, y = other.t[within], other.y[within]
    if len(t) < _FEWEST:
        return False
    apart = np.interp(t, reference.t, reference.y) - y
    rate = np.gradient(y, t)
    moved = float(rate @ rate)
    skew_s = np.clip(float(rate @ apart) / moved, -_SKEW_S, _SKEW_S) if moved > 0.0 else 0.0
    return bool(np.median(np.abs(apart - skew_s * rate)) <= _AGREE_RAD)


def is_fuller(a: Maneuver, b: Maneuver) -> bool:
    """Return whether ``a`` is the better record of a manoeuvre: marked, or with more samples of elevator and
    q."""
    return _fullness(a) > _fullness(b)


def _fullness(maneuver: Maneuver) -> tuple[bool, int]:
    samples = sum(len(maneuver.channels[name]) for name in ("elevator", "q") if name in maneuver.channels)
    return maneuver.span.closed_by.startswith("marked"), samples


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
