"""Conversion of elevator movements to manoeuvres with their channels, or to activities with reasons.

An elevator movement in the preflight check, in the take-off run or after a crash is no test input. The
autopilot's statement EXTENDED_SYS_STATE has priority. The other evidence is the armed flag with ground speed,
speed and height together, and air speed near zero.
"""

from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from math import ceil, radians

import numpy as np

from advisor.aircraft.aircraft import Aircraft, Limits
from advisor.flight.elevator.elevator_guess import ElevatorSign, turned
from advisor.flight.instruments.examined import ExaminedRecords
from advisor.flight.instruments.measured import Evidence
from advisor.flight.maneuvers.announced import PITCH_KINDS, SIDE_KINDS
from advisor.flight.maneuvers.axes.side_inputs import (
    SideInput,
    SideMovement,
    SideStretch,
    at_once,
    named,
    part_of_input,
    with_elevator,
)
from advisor.flight.maneuvers.excitation import PITCH, ROLL, YAW, Loop
from advisor.flight.maneuvers.maneuver import (
    Activity,
    FlightEvent,
    Maneuver,
    ManeuverFlown,
    Notice,
    SideManeuverFlown,
    Span,
)
from advisor.flight.maneuvers.markers import marked_span
from advisor.flight.maneuvers.marks import Mark, Marks
from advisor.flight.maneuvers.purpose import Because, judged
from advisor.flight.maneuvers.steady_speed import HISTORY_S, at_steady_speed
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.flight.stream.maneuver_records import ManeuverRecords
from advisor.flight.vehicle.modes import closes_pitch_loop

# MAV_LANDED_STATE, MAVLink common.xml.
_ON_GROUND, _TAKING_OFF = 1, 3
_FRESH_S = 5.0
"""Time for which a landed state of the autopilot is valid, s. Landed states arrive about once a second."""
STANDING_M_S = 3.0
"""Least ground speed of a moving aircraft, m/s. A receiver at rest shows less than 1 m/s."""
WINDY_M_S = 12.0
"""Largest air speed that wind alone may cause at a parked aircraft, m/s. A higher air speed counts as
flight."""
NEAR_GROUND_M = 3.0
"""Height above the take-off place below which a standing aircraft counts as landed, m."""
_STILL_RAD_S = radians(1.0)
"""Least pitch rate of an aircraft in flight whose elevator moves, rad/s."""

Cut = Callable[[str, float, float], Channel | None]
"""Function that returns a stretch of a channel by name, start and end, s since boot."""


def why_on_ground(span: Span, cut: Cut, limits: Limits) -> str | None:
    """Return in words the evidence that the aircraft did not fly. Return None if the aircraft flew, or
    without evidence.

    Parameters
    ----------
    cut
        Function that returns ``landed_state``, ``armed``, ``groundspeed``, ``airspeed``, ``height`` and ``q``
        if received.
    limits
        Limits of the model in the aircraft file. An air speed within its limit of change belongs to flight,
        however slow it is.
    """
    said = _lately("landed_state", span, cut)
    if _ON_GROUND in said:
        return "the autopilot says that it has landed"
    if _TAKING_OFF in said:
        return "the autopilot says that it takes off"
    if _stands(span, cut):
        if (armed := _lately("armed", span, cut)) and not any(armed):
            return "it is disarmed and stands"
        height_m = _median("height", span, cut)
        if height_m is not None and abs(height_m) < NEAR_GROUND_M:
            return "it stands at the height of take-off"
    ends = [_median("airspeed", span, cut, at_s) for at_s in (span.start_s, span.last_step_s)]
    steady = 1.0 - 0.01 * limits.airspeed_change_percent
    least = min(SLOWEST_FLIGHT_M_S, steady * (_median("airspeed", span, cut) or np.inf))
    if any(speed is not None and 0.0 < speed < least for speed in ends):
        return "it has no flying speed at one end of the movement"
    return None


def _stands(span: Span, cut: Cut) -> bool:
    """Return whether no speed shows motion. A ground speed of exactly zero counts as missing, because the
    receiver may be missing.
    """
    over_ground = _median("groundspeed", span, cut)
    through_air = _median("airspeed", span, cut)
    if over_ground is None or over_ground >= STANDING_M_S or (through_air or 0.0) > WINDY_M_S:
        return False
    q = cut("q", span.start_s, span.end_s)
    still = q is not None and len(q) > 0 and 0.5 * float(np.ptp(q.y)) < _STILL_RAD_S
    return over_ground > 0.0 or still


def _lately(name: str, span: Span, cut: Cut) -> list[float]:
    """Return a channel's value at the beginning of the movement, and all later values."""
    words = cut(name, span.start_s - _FRESH_S, span.end_s)
    if words is None:
        return []
    before = int(np.searchsorted(words.t, span.start_s, side="right"))
    values: list[float] = words.y[max(before - 1, 0) :].tolist()
    return values


def _median(name: str, span: Span, cut: Cut, at_s: float | None = None) -> float | None:
    """Return the median of a channel over the movement, or over one second around a time."""
    start_s, end_s = (span.start_s, span.end_s) if at_s is None else (at_s - 0.5, at_s + 0.5)
    channel = cut(name, start_s, end_s)
    return float(np.median(channel.y)) if channel is not None and len(channel) else None


_EDGE_S = 0.5
"""Time before and after an elevator movement in which aileron and rudder may begin and end one input, s."""


class Cutting:
    """Cutter of manoeuvres from the tracks of one vehicle."""

    def __init__(
        self, records: ManeuverRecords, aircraft: Aircraft, marks: Marks, lateral: bool = False
    ) -> None:
        self.records, self._tracks = records, records.tracks
        self._limits, self._marks = aircraft.limits, marks
        self._sign = None if aircraft.elevator.is_calibrated else ElevatorSign()
        self._lateral = lateral
        self.pitch, self.sideways = records.pitch, records.sideways
        self.activities: Counter[str] = Counter()
        """Number of movements that were no test inputs, by their description."""
        self.side_due: list[SideStretch] = []
        """Stretches whose record of aileron and rudder is not yet cut, in the order of their completion."""
        self._claimed: list[SideStretch] = []
        self._tests: dict[str, list[Span]] = {}
        self._passed_over: tuple[tuple[float, ...], bool] = ((), False)
        """Manoeuvre in flight whose input is over, with the second of its newest sample, and whether the
        input is no test.
        """

    @property
    def is_backwards(self) -> bool:
        """Whether the elevator was found to move opposite to its output's nominal sign."""
        return self._sign is not None and bool(self._sign.backwards)

    def begin(self, mode: str) -> None:
        """Forget all manoeuvres, and begin a power-on in a flight mode."""
        self.records.begin(mode)
        self.side_due.clear()
        self._claimed.clear()
        self._tests.clear()

    def so_far(self, span: Span, boot: int) -> Maneuver | None:
        """Return the manoeuvre if the movement ended now; None if its finished input is no test input."""
        maneuver, _ = self.records.of_pitch(span, boot, None, grows=True)
        if span.input_is_over:
            at = (boot, span.start_s, span.last_step_s, ceil(span.end_s))
            if self._passed_over[0] != at:
                self._passed_over = at, self._not_an_input(maneuver, None) is not None
            if self._passed_over[1]:
                return None
        return turned(maneuver) if self.is_backwards else maneuver

    def flown(self, span: Span, boot: int, up_to_order: int | None) -> list[FlightEvent]:
        """Return the event of a finished movement: a manoeuvre, or an activity with its reason."""
        maneuver, evidence = self.records.of_pitch(span, boot, up_to_order)
        verdict = self._judged(maneuver, up_to_order)
        if isinstance(verdict, Because):
            return [self._activity(maneuver, verdict)]
        if verdict is not span:
            span = verdict
            maneuver, evidence = self.records.of_pitch(span, boot, up_to_order)
        if self._lateral and (sides := self._beside(span, up_to_order)):
            joint = self._claim(span, SideInput(sides), boot, up_to_order)
            if joint is not None:
                return self._counted(*self.records.of_pitch(joint, boot, up_to_order))
        airspeed = maneuver.channels.get("airspeed")
        steady = at_steady_speed(maneuver.span, airspeed, self._limits.airspeed_change_percent)
        if steady is not maneuver.span:
            maneuver, evidence = self.records.of_pitch(steady, boot, up_to_order)
        return self._counted(maneuver, evidence)

    def _beside(self, span: Span, up_to_order: int | None) -> tuple[SideMovement, ...]:
        """Return the movements of aileron and rudder that form one input with a movement of the elevator."""
        mark = Mark(span.start_s - _EDGE_S, min(span.last_step_s + 2.0 * _EDGE_S, span.end_s))
        sides = [
            SideMovement(loop, marked_span(mark, self._tracks.cut(loop.control, *mark.reach, up_to_order)))
            for loop in (ROLL, YAW)
        ]
        return with_elevator(SideMovement(PITCH, span), sides)

    def _claim(self, span: Span, side_input: SideInput, boot: int, up_to_order: int | None) -> Span | None:
        """Return the common extent of an input of several controls, whose lateral record becomes due.

        None if aileron and rudder made no test input of their own.
        """
        joint = at_once(span, SideInput((SideMovement(PITCH, span), *side_input.movements)))
        sideways = replace(joint, kind=named(side_input), steps=side_input.main.span.steps)
        if self.is_no_side_input(
            self.records.of_sides(sideways, boot, up_to_order)[0], side_input, up_to_order
        ):
            return None
        stretch = SideStretch(up_to_order, sideways, side_input, boot)
        self.side_due.append(stretch)
        self._claimed.append(stretch)
        return joint

    def claims(self, span: Span, up_to_order: int | None) -> bool:
        """Return whether an input of all controls that is already complete overlaps a span."""
        return any(
            stretch.span.start_s < span.last_step_s and span.start_s < stretch.span.last_step_s
            for stretch in self._claimed
            if up_to_order is None or (stretch.order is not None and stretch.order <= up_to_order)
        )

    def side_events(self, stretch: SideStretch) -> list[FlightEvent]:
        """Return the event of a stretch of aileron and rudder; empty where the stretch is no test input."""
        maneuver, evidence = self.records.of_sides(stretch.span, stretch.boot, stretch.order)
        if stretch.swept and self.is_no_side_input(maneuver, stretch.side_input, stretch.order):
            return []
        return self.side_counted(maneuver, evidence)

    def marked(self, mark: Mark, boot: int, up_to_order: int | None) -> list[FlightEvent]:
        """Return the pitch manoeuvre of a marked stretch, without the criteria for unmarked movements.

        The stretch is a manoeuvre of the elevator, of aileron and rudder, or of both, depending on the moved
        controls. The lateral manoeuvre becomes due in ``side_due``. A stretch without any movement counts as
        one of the elevator. SystemID moves any control, even in hover, so each control's visible effect
        decides.
        """
        said = mark.announced
        if said is not None and (no_test := said.no_test(mark.end_s - mark.start_s)) is not None:
            return [self._listed(mark.start_s, mark.end_s, Because(*no_test), boot)]
        mark = mark.until(self.records.leaves_s(mark.end_s))
        spans = {
            loop: marked_span(mark, self._tracks.cut(loop.control, *mark.reach, up_to_order))
            for loop in (PITCH, ROLL, YAW)
        }
        moved = part_of_input([SideMovement(loop, span) for loop, span in spans.items()])
        if said is not None:
            # The loop moves the other controls.
            moved = tuple(m for m in moved if said.moves(m.loop.control)) or moved
        rest = all(m.rests_by(mark.end_s) for m in moved)
        if said is not None and len(moved) > 1 and rest and not self.pilot_flies(mark.end_s):
            # After the mark the autopilot's loop moves the surfaces. An input at once does not need this
            # motion. A doublet does: the loop is the second input that separates the derivatives.
            spans = {loop: replace(span, end_s=mark.end_s) for loop, span in spans.items()}
            moved = tuple(SideMovement(m.loop, spans[m.loop]) for m in moved)
        sides = tuple(m for m in moved if m.loop is not PITCH) if self._lateral else ()
        swept = mark.by == "system id"
        pitching = spans[PITCH]
        if said is not None:
            pitching = replace(pitching, kind=said.kind(PITCH_KINDS, pitching.kind))
        events: list[FlightEvent] = []
        if not sides or len(sides) < len(moved):
            if sides:
                pitching = at_once(pitching, SideInput(moved))
            maneuver, evidence = self.records.of_pitch(pitching, boot, up_to_order)
            because = self._not_an_input(maneuver, up_to_order) if swept else None
            events += (
                self._counted(maneuver, evidence) if because is None else [self._activity(maneuver, because)]
            )
        if sides:
            side_input = SideInput(sides)
            kind = named(side_input) if said is None else said.kind(SIDE_KINDS, named(side_input))
            span = replace(at_once(side_input.main.span, SideInput(moved)), kind=kind)
            self.side_due.append(SideStretch(up_to_order, span, side_input, boot, swept))
        return events

    def is_no_side_input(self, maneuver: Maneuver, side_input: SideInput, up_to_order: int | None) -> bool:
        """Return whether no movement in an input of aileron and rudder is a test input."""
        on_ground = self.why_on_ground(maneuver.span, up_to_order)
        passed_over = self._marks.script_passes_over(maneuver.span, up_to_order)
        for part in side_input.movements:
            if part.loop.control not in maneuver.channels:
                continue
            alone = replace(part.span, record_from_s=maneuver.span.record_from_s, end_s=maneuver.span.end_s)
            motion = self.motion_before(alone, part.loop, up_to_order)
            moved, tests = replace(maneuver, span=alone), self._tests.get(part.loop.control, ())
            extent = judged(moved, on_ground, motion, None, part.loop, tests, passed_over=passed_over)
            if isinstance(extent, Span):
                return False
        return True

    def _activity(self, maneuver: Maneuver, because: Because) -> Activity:
        """Return the event of a movement that was no test input, and count it."""
        return self._listed(maneuver.span.start_s, maneuver.span.end_s, because, maneuver.boot)

    def _listed(self, start_s: float, end_s: float, because: Because, boot: int) -> Activity:
        """Return the event of a stretch that was no test input, and count the event."""
        self.activities[because.what] += 1
        stay_s, _ = self.records.stay(0.5 * (start_s + end_s))
        return Activity(start_s, end_s, because.reason, because.text, stay_s, boot)

    def _counted(self, maneuver: Maneuver, evidence: Evidence) -> list[FlightEvent]:
        news = _news(maneuver, evidence, self.pitch)
        self._tests.setdefault(PITCH.control, []).append(maneuver.span)
        self.records.release(maneuver)
        if self._sign is None or "elevator" not in maneuver.channels:
            return [*news, ManeuverFlown(maneuver)]
        maneuver, notices = self._sign.right(maneuver)
        return [*news, *notices, ManeuverFlown(maneuver)]

    def why_on_ground(self, span: Span, up_to_order: int | None = None) -> str | None:
        """Return evidence that the aircraft was on the ground during a movement; None without evidence."""
        return why_on_ground(span, partial(self._tracks.cut, up_to_order=up_to_order), self._limits)

    def _not_an_input(self, maneuver: Maneuver, up_to_order: int | None) -> Because | None:
        verdict = self._judged(maneuver, up_to_order)
        return verdict if isinstance(verdict, Because) else None

    def _judged(self, maneuver: Maneuver, up_to_order: int | None) -> Because | Span:
        span = maneuver.span
        motion = self.motion_before(span, PITCH, up_to_order)
        on_ground = self.why_on_ground(span, up_to_order)
        tests = self._tests.get(PITCH.control, ())
        passed_over = self._marks.script_passes_over(span, up_to_order)
        return judged(maneuver, on_ground, motion, self._limits, PITCH, tests, passed_over=passed_over)

    def pilot_flies(self, at_s: float) -> bool:
        """Return whether the pilot moves the elevator at this time, according to the flight mode."""
        return not closes_pitch_loop(self.records.stay(at_s)[1])

    def side_counted(self, maneuver: Maneuver, evidence: Evidence) -> list[FlightEvent]:
        """Return the event of a lateral manoeuvre, after notices about its instruments."""
        for loop in (ROLL, YAW):
            # The levels belong to one of the controls, so that they say nothing of the size of the others.
            self._tests.setdefault(loop.control, []).append(replace(maneuver.span, steps=()))
        return [*_news(maneuver, evidence, self.sideways), SideManeuverFlown(maneuver)]

    def motion_before(self, span: Span, loop: Loop, up_to_order: int | None) -> dict[str, Channel]:
        """Return a control and its motion during a movement and before it."""
        from_s = span.start_s - HISTORY_S
        names = [name for name in (loop.control, loop.rate, loop.angle) if name]
        cut = {name: self._tracks.cut(name, from_s, span.end_s, up_to_order) for name in names}
        return {name: channel for name, channel in cut.items() if channel is not None}


def _news(maneuver: Maneuver, evidence: Evidence, axis: ExaminedRecords) -> list[Notice]:
    """Count a manoeuvre of an axis, and return a notice for every new contradiction of its instruments."""
    codes = {f.code for f in axis.findings}
    axis.count(evidence, maneuver.findings)
    return [Notice(f.code, str(f.problem)) for f in maneuver.findings if f.code not in codes]
