"""Frozen state of a campaign at one moment for screens, texts and documents, and the engineer's decisions by
hand.

Each decision refers to vehicle time instead of a manoeuvre's number, because a mark changes the numbers.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite
from statistics import median
from typing import Any, Generic, Literal, TypeVar

from advisor.decision.arriving import Arriving
from advisor.decision.verdict import CrewPlan, FlightTestVerdict, ManeuverVerdict, crew_plan
from advisor.flight.elevator.elevator_guess import Guess
from advisor.flight.maneuvers.maneuver import Activity, Maneuver
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.maneuvers.movement import FREE_S
from advisor.flight.maneuvers.segmentation import LEAD_IN_S
from advisor.flight.signals.track import ChannelStatus, Course
from advisor.flight.signals.trust import InstrumentFinding
from advisor.flight.stream.flights import FlightHeard
from advisor.flight.vehicle.vehicle import Vehicle
from advisor.oem.axis.estimate import AxisEstimate
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.process.parts import FailedPart
from advisor.words.axes import AXES, AxisName
from advisor.words.problems import Problem


@dataclass(frozen=True, slots=True)
class JudgedManeuver:
    """One manoeuvre, its estimate and its verdict."""

    maneuver: Maneuver
    estimate: Estimate | NoEstimate
    verdict: ManeuverVerdict
    excluded_because: str | None = None
    """Reason for which an engineer excluded the manoeuvre; None: the manoeuvre is included."""
    notes: tuple[str, ...] = ()
    """Notes of the engineer on the manoeuvre."""


E = TypeVar("E", bound=Estimate)


@dataclass(frozen=True)
class AxisState(Generic[E]):
    """State of the campaign of one axis."""

    maneuvers: tuple[JudgedManeuver, ...]
    flight_test: FlightTestVerdict
    model: E | None
    """Joint estimate. In flight it uses the newest accepted manoeuvres, after the end all accepted
    manoeuvres.
    """
    estimate_from: tuple[int, ...] = ()
    """Numbers of the manoeuvres in the joint estimate ``model``."""

    @property
    def has_begun(self) -> bool:
        """Whether the crew tests this axis (:func:`has_begun`)."""
        return has_begun(self.maneuvers)

    @property
    def is_accepted(self) -> bool:
        """Whether any manoeuvre is accepted."""
        return any(judged.verdict.accepted for judged in self.maneuvers)


LateralState = AxisState[AxisEstimate]
"""State of the campaign of roll and yaw."""


OF_ELEVATOR = frozenset({"no_maneuver", "no_elevator", "no_alpha"})
"""Codes of problems that affect only the elevator's axis."""


_EVERY_S = 1.0
"""Vehicle time between two pictures of the whole flight, s. A picture of many minutes does not visibly change
sooner."""


def has_begun(judged: Sequence[JudgedManeuver]) -> bool:
    """Return whether the test of an axis has begun: by a named or marked input, or an accepted movement.

    A refused pulse does not count, because hands that trim an axis also move its control away and back.
    """
    return any(
        m.verdict.accepted or m.maneuver.span.is_marked or m.maneuver.span.kind not in ("other", "pulse")
        for m in judged
    )


@dataclass(frozen=True, slots=True, eq=False)
class WholeFlight:
    """Channels and flight modes of the current power-on."""

    courses: Mapping[str, Course] = field(default_factory=dict)
    modes: tuple[tuple[float, str], ...] = ()
    """Start of each flight mode, in vehicle time, s since boot, with the mode's name."""


class WholeFlights:
    """Keeps the picture of the current power-on, and renews it at intervals."""

    def __init__(self) -> None:
        self._newest = WholeFlight()
        self._at: tuple[tuple[int, int], float] | None = None
        self._power_on = (0, 0)
        self._modes: tuple[tuple[float, str], ...] = ()

    def change_mode(self, power_on: tuple[int, int], at_s: float, mode: str) -> None:
        """Record a change of the flight mode at a vehicle time, s; NaN before the clock is received."""
        if power_on != self._power_on:
            self._power_on, self._modes = power_on, ()
        self._modes = (*self._modes, (at_s if isfinite(at_s) else 0.0, mode))

    def now(
        self, power_on: tuple[int, int], now_s: float, courses: Callable[[], Mapping[str, Course]]
    ) -> WholeFlight:
        """Return the picture of the flight; the identical object until the picture is renewed."""
        if self._at is not None and self._at[0] == power_on and now_s < self._at[1] + _EVERY_S:
            return self._newest
        if isfinite(now_s):
            self._at = power_on, now_s
            modes = self._modes if power_on == self._power_on else ()
            self._newest = WholeFlight(courses(), modes)
        return self._newest


@dataclass(frozen=True, slots=True)
class CampaignState:
    """State of a campaign after its newest sample."""

    vehicle: Vehicle | None
    """Vehicle whose messages are read. None before the first heartbeat."""
    now_s: float
    """Vehicle time of the newest sample, seconds since boot."""
    mode: str
    channels: Mapping[str, ChannelStatus]
    axes: Mapping[AxisName, AxisState[Any]]
    """State of the campaign of every requested axis."""
    shown: AxisName = AXES[0]
    """Axis of ``maneuvers``, ``flight_test``, ``model`` and ``estimate_from``."""
    flying: Maneuver | None = None
    """Manoeuvre that is being flown, up to the newest sample. None between manoeuvres."""
    marking_since_s: float | None = None
    """Start of an open mark by hand, s since boot. None without an open mark."""
    arriving: Arriving | None = None
    """Errors of the derivatives with the information of the input that is being flown, at whole seconds."""
    judging: bool = False
    """Whether a manoeuvre has been flown and is being judged."""
    elevator_notes: tuple[str, ...] = ()
    """Assumptions about the elevator's scale and sign, as sentences."""
    reader_notes: tuple[str, ...] = ()
    """Choices and omissions of the log's reader, as sentences."""
    elevator_guess: Guess | None = None
    """Guess of the elevator's output channel, if no parameter states the channel."""
    other_vehicles: tuple[int, ...] = ()
    """System ids of the other vehicles on the link, in rising order."""
    no_data: tuple[Problem, ...] = ()
    """Reasons for which the present data are insufficient; empty for sufficient data."""
    whole_flight: WholeFlight = field(default_factory=WholeFlight)
    """The current power-on, as one picture of the whole flight."""
    serves: bool = True
    """Whether the present data are known to be sufficient. False before the data are judged for the first
    time."""
    instruments: tuple[InstrumentFinding, ...] = ()
    """Contradictions of the instruments."""
    mark_notes: tuple[str, ...] = ()
    """Marks that could not be used, each with its reason."""
    notices: tuple[str, ...] = ()
    """Newest sentences of the event log with the vehicle's time, oldest first."""
    flight: int = 0
    """Number of the current log or link, 0 for the first."""
    boot: int = 0
    """Number of the vehicle's power-on in this log or link, 0 for the first."""
    flights: tuple[FlightHeard, ...] = ()
    """Every log and link so far. The last entry is the current log or link."""
    activity: tuple[Activity, ...] = ()
    """Elevator movements that were no test inputs, oldest first. Consecutive similar movements are one
    entry."""
    failed: tuple[FailedPart, ...] = ()
    """Parts that were ended by a fault of the advisor."""

    @property
    def maneuvers(self) -> tuple[JudgedManeuver, ...]:
        """Manoeuvres of the shown axis, in the order flown."""
        return self.axes[self.shown].maneuvers

    @property
    def flight_test(self) -> FlightTestVerdict:
        """Decision of the shown axis whether the test may stop."""
        return self.axes[self.shown].flight_test

    @property
    def model(self) -> Estimate | None:
        """Joint estimate of the shown axis."""
        return self.axes[self.shown].model

    @property
    def estimate_from(self) -> tuple[int, ...]:
        """Numbers of the manoeuvres in the joint estimate of the shown axis."""
        return self.axes[self.shown].estimate_from

    @property
    def lateral(self) -> LateralState | None:
        """State of the campaign of roll and yaw. None if these were not requested."""
        return self.axes.get("lateral")

    @property
    def plan(self) -> CrewPlan | None:
        """Plan of both axes; None if the test of one axis has not begun."""
        if len(self.axes) < len(AXES) or not all(axis.has_begun for axis in self.axes.values()):
            return None
        return crew_plan(*(self.axes[axis].flight_test for axis in AXES))

    @property
    def tested_sideways(self) -> LateralState | None:
        """The lateral state if the test of roll and yaw has begun, and the test of the shown axis has not."""
        side = self.lateral
        return None if side is None or self.axes[self.shown].has_begun or not side.has_begun else side

    @property
    def lateral_alone(self) -> LateralState | None:
        """The lateral state if only the lateral axes have accepted manoeuvres; else None."""
        side = self.lateral
        return None if side is None or self.axes["pitch"].is_accepted or not side.is_accepted else side

    @property
    def is_recorded(self) -> bool:
        """Whether the manoeuvre in flight may end: its input is over, and its free response is long enough to
        be judged."""
        # Screens import this module at once, but the natural period needs the libraries that estimate.
        from advisor.decision.envelope import shortest_response_s
        from advisor.decision.first_unit import natural_period

        if self.flying is None or self.tested_sideways is not None:
            return False
        span, period_s = self.flying.span, natural_period(self.flying, self.model)
        least_s = max(FREE_S[0], shortest_response_s(period_s))
        return span.input_is_over and span.end_s - span.last_step_s >= least_s

    @property
    def progress(self) -> str:
        """Duration of the current manoeuvre so far, with the duration of earlier ones; empty between
        manoeuvres."""
        if self.flying is None:
            return ""
        flown_s = self.now_s - self.flying.span.start_s
        before = [
            j.maneuver.span.end_s - j.maneuver.span.start_s for j in self.maneuvers if j.verdict.accepted
        ]
        return f"flown {flown_s:.0f} s of {median(before):.0f}" if before else f"flown {flown_s:.0f} s"


@dataclass(frozen=True, slots=True)
class Remark:
    """The engineer's sentence on one moment of the flight."""

    at_s: float
    """Vehicle time of the remark, s since boot."""
    text: str
    boot: int = 0
    """Number of the power-on, 0 for the first power-on in the log."""
    flight: int = 0
    """Number of the log or link in the campaign, 0 for the first."""

    def concerns(self, maneuver: Maneuver) -> bool:
        """Return whether the remark's moment lies in a manoeuvre, including the manoeuvre's lead-in."""
        span = maneuver.span
        here = (self.flight, self.boot) == maneuver.power_on
        return here and span.start_s - LEAD_IN_S <= self.at_s < span.end_s


@dataclass(frozen=True, slots=True)
class ByHand:
    """The engineer's decisions by hand, in the order in which they were made."""

    marks: tuple[Mark, ...] = ()
    """Time intervals that the engineer marked as manoeuvres."""
    excluded: tuple[Remark, ...] = ()
    """Manoeuvres excluded from every decision, each with the reason."""
    notes: tuple[Remark, ...] = ()
    """The engineer's notes on manoeuvres."""
    remarks: tuple[Remark, ...] = ()
    """Moments of the flight that are marked in the event log."""

    def excluded_because(self, maneuver: Maneuver) -> str | None:
        """Return the reason for which a manoeuvre is excluded; None for an included manoeuvre."""
        return next((r.text for r in self.excluded if r.concerns(maneuver)), None)

    def notes_on(self, maneuver: Maneuver) -> tuple[str, ...]:
        return tuple(r.text for r in self.notes if r.concerns(maneuver))

    def excluding(self, maneuver: Maneuver, because: str | None) -> "ByHand":
        """Return the decisions with a manoeuvre excluded for a reason, or included again if the reason is
        None."""
        others = tuple(r for r in self.excluded if not r.concerns(maneuver))
        added = () if because is None else (_on(maneuver, because),)
        return replace(self, excluded=(*others, *added))

    def noting(self, maneuver: Maneuver, text: str) -> "ByHand":
        """Return the decisions with one more note on a manoeuvre."""
        return replace(self, notes=(*self.notes, _on(maneuver, text)))

    def remarking(self, remark: Remark) -> "ByHand":
        """Return the decisions with one more moment marked in the event log."""
        return replace(self, remarks=(*self.remarks, remark))

    def marking(self, mark: Mark) -> "ByHand":
        """Return the decisions with one more marked manoeuvre."""
        return replace(self, marks=(*self.marks, mark))

    def on_flight(self, flight: int) -> "ByHand":
        """Return the decisions on one log or link, numbered as if it were the only one."""
        return self._each(lambda entry: [replace(entry, flight=0)] if entry.flight == flight else [])

    def as_flight(self, flight: int) -> "ByHand":
        """Return the decisions on a single log or link, numbered as a flight of a campaign."""
        return self._each(lambda entry: [replace(entry, flight=flight)])

    def _each(self, changed: Callable[[Any], list[Any]]) -> "ByHand":
        """Return the decisions with ``changed`` applied to each of the lists."""
        sections = (self.marks, self.excluded, self.notes, self.remarks)
        return ByHand(*(tuple(new for entry in section for new in changed(entry)) for section in sections))


NOTHING = ByHand()
"""Empty decisions by hand."""


def on_all(decided: Sequence[ByHand]) -> ByHand:
    """Return the decisions on all logs of a campaign, from the decisions on each log."""
    flights = [hand.as_flight(flight) for flight, hand in enumerate(decided)]
    return ByHand(
        tuple(mark for hand in flights for mark in hand.marks),
        tuple(remark for hand in flights for remark in hand.excluded),
        tuple(remark for hand in flights for remark in hand.notes),
        tuple(remark for hand in flights for remark in hand.remarks),
    )


def _on(maneuver: Maneuver, text: str) -> Remark:
    return Remark(round(maneuver.span.start_s, 3), text, maneuver.boot, maneuver.flight)


Verb = Literal["exclude", "include", "note", "mark", "begin", "end"]
"""Kind of decision by hand: ``mark`` names a moment in the log; ``begin`` and ``end`` mark a manoeuvre."""


@dataclass(frozen=True, slots=True)
class HandDecision:
    """One decision by hand, with the engineer's reason."""

    verb: Verb
    text: str = ""
    """Text of the decision: a reason, a note or the name of the moment."""
    number: int = 0
    """Number of the manoeuvre; 0 for a decision on the present moment."""
    axis: AxisName = "pitch"
    """Axis of the manoeuvre."""

    def due(self, state: CampaignState) -> bool:
        """Return whether the flight has reached the manoeuvre or moment of the decision."""
        flown = state.axes[self.axis].maneuvers if self.axis in state.axes else ()
        return self.number == 0 or any(judged.maneuver.number == self.number for judged in flown)
