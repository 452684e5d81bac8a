"""Classification of an elevator movement: an identifiable input, or another activity with a reason.

The shape of the movement does not matter. The criteria are whether the aircraft flew, who moved the elevator,
and how well the pitch rate shows the elevator's effect.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from math import degrees, isfinite, radians

import numpy as np

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.excitation import PITCH, Loop, excitation, flown_elsewhere
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.markers import SWEPT, marked_span
from advisor.flight.maneuvers.marks import Mark
from advisor.flight.maneuvers.movement import FREE_S, SMALLEST_RAD
from advisor.flight.maneuvers.steady_speed import shows_hands
from advisor.flight.maneuvers.stepped_input import Odds, odds_of_own_input
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.flight.vehicle.modes import closes_pitch_loop, has_an_errand, hovers, is_manual
from advisor.words.quantities import distinct_texts

_BEFORE_S = 0.5
"""Length before an input over which the rate is averaged, s: the least rest of the control."""
_OF_TESTS = 0.25
"""Least amplitude of a test, over the median of the tests before it. 250 flown tests have at least 0.39.
Movements of the hands between tests, which no other criterion recognises, have up to 0.23."""
_STEADY = 0.5
"""Largest mean rate before a test, over half the range of the rate within. 260 flown tests of eleven aircraft
have at most 0.31. Movements of hands that counter a rotation have up to 1.5."""


def begun_in_motion(span: Span, rate: Channel, loop: Loop) -> str | None:
    """Return the reason why an input does not begin from steady flight; None if it does.

    A rotation that continues after the input is a turn, which is steady flight.
    """
    before = rate.cut(span.start_s - _BEFORE_S, span.start_s).y
    within = rate.cut(span.start_s, span.end_s).y
    if len(before) < 2 or len(within) < 2:
        return None
    after = rate.cut(span.end_s - _BEFORE_S, span.end_s).y
    turns = float(np.mean(before))
    stops = min(abs(turns), abs(turns - float(np.mean(after)))) if len(after) else abs(turns)
    share = stops / max(0.5 * float(np.ptp(within)), 1e-12)
    if share <= _STEADY:
        return None
    shown, most = distinct_texts(100.0 * share, 100.0 * _STEADY)
    begins = f"the {loop.rate_said} before the {loop.control} moved was {shown} % of that after"
    return f"{begins} (limit {most}), and a test begins from rest; not a test input"


def much_smaller(span: Span, tests: Sequence[Span], control: str) -> str | None:
    """Return the reason why an input is much smaller than the tests before; None if it is not.

    A 3-2-1-1 of any size is accepted, because hands fly no 3-2-1-1 by accident.
    """
    if "3-2-1-1" in span.kind:
        return None
    before = [_amplitude(test) for test in tests if test.steps]
    share = _amplitude(span) / max(float(np.median(before)), 1e-12) if before else 1.0
    if share >= _OF_TESTS:
        return None
    shown, least = distinct_texts(100.0 * share, 100.0 * _OF_TESTS)
    return f"a correction: the {control} moved by {shown} % of the tests before (at least {least})"


def _amplitude(span: Span) -> float:
    return max((abs(level) for _, level in span.steps), default=0.0)


_SHARP_S = 0.06
"""Half of the largest duration of an external input's step, s. Feedback of the aircraft's motion is
slower."""
_SLOWEST_S = 0.15
"""Largest sampling interval of the elevator, s, at which a sharp step is visible."""
_SHARP = 0.5
"""Least share of a sharp step within twice ``_SHARP_S``."""
_FEWEST_SHARP = 3
"""Least number of sharp steps for an external input. A control loop makes one sharp step when it is switched
on, and one when its demand jumps."""


def moves_in_sharp_steps(maneuver: Maneuver, control: str) -> bool:
    """Return whether the control moves in sharp steps, which no feedback of the motion makes."""
    elevator = maneuver.channels[control]
    interval_s = float(np.median(np.diff(elevator.t))) if len(elevator) > 1 else np.inf
    if interval_s > _SLOWEST_S:
        return False
    reach = max(_SHARP_S, 1.01 * interval_s)
    steps = [(maneuver.span.start_s, 0.0), *maneuver.span.steps]
    sharp = 0
    for (_, old), (onset, new) in pairwise(steps):
        before, after = np.interp([onset - reach, onset + reach], elevator.t, elevator.y)
        done = (after - before) * np.sign(new - old)
        sharp += abs(new - old) >= 2.0 * SMALLEST_RAD and done >= _SHARP * abs(new - old)
    return sharp >= max(_FEWEST_SHARP, 0.6 * (len(steps) - 1))


LEAST_PITCH_RATE_DEG_S = 1.0
"""Least pitch rate response to a test input, deg/s. Light turbulence hides smaller pitch rates. The gentlest
recorded test input has 1.3 deg/s (a jet), and a correction of another jet has 0.7 deg/s."""
LARGEST_ERROR = 0.3
"""Largest relative standard error of the elevator's effect on the pitch rate; 0.3 is significant at 2 %.
Recorded test inputs have an error of 0.01 to 0.12 in calm air, and of 0.16 in gusts of 0.5 m/s. Behind an
autopilot, recorded test inputs have an error of up to 0.21. An attitude hold in gusts has 0.3 to 2."""
LEAST_PROBABILITY = 0.95
"""Least probability of an own input, for a test: the level of all intervals. Below this probability a stretch
is not used. Below one minus this probability, the message says that hands moved the control.
"""
_LATER_S = 0.5
"""Least time from the movement's begin to the begin of a separate input that cuts the movement, s. The time
is the edge of a hand-flown step.
"""
_WHAT = {
    "ground": "movements without flight",
    "small": "corrections",
    "elsewhere": "movements in turns, climbs and changes of speed",
    "feedback": "movements of the hands that hold the attitude",
    "undecided": "movements that the hands or a test may have made",
    "no_information": "movements without a visible effect",
    "unsettled": "movements that never came to rest",
    "aborted": "inputs that a script ended early",
    "bounce": "inputs of a bouncing switch",
}


@dataclass(frozen=True, slots=True)
class Because:
    """Reason why a movement is no test input."""

    reason: str
    """``aborted``, ``autopilot``, ``bounce``, ``elsewhere``, ``feedback``, ``ground``, ``hover``,
    ``no_information``, ``small``, ``undecided`` or ``unsettled``."""
    text: str
    """Sentence about the reason, with its number and limit."""

    @property
    def what(self) -> str:
        """Kind of movement in words, without numbers."""
        return _WHAT.get(self.reason, self.text)


def judged(
    maneuver: Maneuver,
    on_ground: str | None = None,
    motion: Mapping[str, Channel] | None = None,
    limits: Limits | None = None,
    loop: Loop = PITCH,
    tests: Sequence[Span] = (),
    *,
    passed_over: bool = False,
) -> Because | Span:
    """Return the extent of the test input in a movement of a control, or the reason why there is none.

    Parameters
    ----------
    maneuver
        Record of the movement. Channels ``q`` and ``airspeed`` are used if present.
    on_ground
        Other evidence that the aircraft did not fly, in words. None without such evidence.
    motion
        Control, rate and angle from a time before the movement, for `odds_of_own_input`. None for the
        channels of the record.
    limits
        Limits of bank and air speed in the aircraft file. None for the usual limits.
    loop
        Control that moved, and the motion that responds. Slow movements outside the limits are sought for the
        elevator alone.
    tests
        Earlier tests of the control in this power-on.
    passed_over
        Whether a script in the autopilot announces its inputs, but not this movement. In a mode with a closed
        loop the loop then made the movement.
    """
    control = loop.control
    if on_ground is not None:
        return Because("ground", f"the {control} moved on the ground: {on_ground}")
    if _is_on_ground(maneuver):
        return Because("ground", f"the {control} moved while the aircraft did not fly")
    if hovers(maneuver.mode):
        return Because("hover", f"the {control} moved in {maneuver.mode}, where rotors carry the aircraft")
    verdict = _told(maneuver, maneuver.channels if motion is None else motion, loop, tests)
    because = verdict if isinstance(verdict, Because) else None
    lacks = _lacks_in_a_loop(maneuver, because, control, passed_over)
    if closes_pitch_loop(maneuver.mode) and lacks:
        what = "SystemID ran" if _is_swept(maneuver) else f"the {control} moved"
        return Because("autopilot", f"{what} in {maneuver.mode}{lacks}; not a test input")
    if (
        because is None
        and loop is PITCH
        and (how := flown_elsewhere(maneuver, limits or Limits())) is not None
    ):
        return Because("elsewhere", f"the elevator moved slowly {how}; not a test input")
    return verdict


def _lacks_in_a_loop(maneuver: Maneuver, because: Because | None, control: str, passed_over: bool) -> str:
    """Return in words what a movement in a closed loop lacks as a test input; empty if it lacks nothing."""
    if has_an_errand(maneuver.mode):
        return " by the autopilot's own task"
    if passed_over and not _is_swept(maneuver):
        return ", and the script in the autopilot announced no input"
    if not _is_swept(maneuver) and not moves_in_sharp_steps(maneuver, control):
        return " without the sharp steps of a test"
    return f", and {because.text.partition('; ')[0]}" if because else ""


def _told(
    maneuver: Maneuver, motion: Mapping[str, Channel], loop: Loop, tests: Sequence[Span]
) -> Because | Span:
    """Return the extent of an input that the rate shows, or the reason why the rate shows none."""
    control, span = loop.control, maneuver.span
    if span.closed_by == "no rest":
        return Because("unsettled", f"the {control} never came to rest; not a test input")
    if _is_swept(maneuver) and not span.steps:
        return Because("small", f"the {control} stood still; not a test input")
    answer = excitation(maneuver, loop)
    if answer is None:
        return span
    rate = degrees(answer.rate)
    if answer.rate < radians(LEAST_PITCH_RATE_DEG_S):
        shown, least = distinct_texts(rate, LEAST_PITCH_RATE_DEG_S, 2, "g")
        return Because(
            "small", f"a correction: the {loop.rate_said} moved by {shown} deg/s only (at least {least})"
        )
    moved = motion.get(control, maneuver.channels[control])
    # A part behind a leap of the stamps shows nothing of the seconds before.
    hidden = bool(maneuver.leapt_s) or not shows_hands(moved)
    asked = not hidden and not _is_swept(maneuver) and not closes_pitch_loop(maneuver.mode)
    odds, flown = None, [(test.start_s, test.end_s) for test in tests]
    if asked and loop.rate in motion:
        odds = odds_of_own_input(span, moved, motion[loop.rate], motion.get(loop.angle), answer.effect, flown)
    # For an elevator moved from outside, no other evidence is needed to separate cause from effect.
    outside = is_manual(maneuver.mode) or moves_in_sharp_steps(maneuver, control)
    error = answer.relative_error if outside else answer.external_error
    if error > LARGEST_ERROR:
        share = "not at all"
        if isfinite(error) and error < 1.0:
            shown, most = distinct_texts(100.0 * error, 100.0 * LARGEST_ERROR)
            share = f"to {shown} % only (limit {most})"
        return Because("no_information", f"the {control}'s effect on the {loop.rate_said} is known {share}")
    if odds is not None and odds.probability < LEAST_PROBABILITY:
        return _as_hands(odds, control)
    part = span if odds is None else _part(span, odds, moved)
    if not asked:
        return part
    moving = motion.get(loop.rate)
    if moving is not None and (unsteady := begun_in_motion(part, moving, loop)):
        return Because("feedback", unsteady)
    smaller = much_smaller(part, tests, control)
    return part if smaller is None else Because("small", smaller)


def _as_hands(odds: Odds, control: str) -> Because:
    """Return the reason why hands that hold the attitude may have made a movement."""
    shown, least = distinct_texts(100.0 * odds.probability, 100.0 * LEAST_PROBABILITY)
    own = f"the probability of a separate input is {shown} % (at least {least})"
    if odds.probability < 1.0 - LEAST_PROBABILITY:
        return Because("feedback", f"hands held the attitude with the {control}: {own}; not a test input")
    return Because("undecided", f"hands, or a test, moved the {control}: {own}; counts for nothing")


def _part(span: Span, odds: Odds, control: Channel) -> Span:
    """Return the span of the separate input within a movement that begins or ends with the hands."""
    if odds.begins_s - span.start_s <= _LATER_S and odds.ends_s >= span.last_step_s:
        return span
    ends_s = min(odds.ends_s, span.last_step_s)
    end_s = span.end_s if ends_s == span.last_step_s else min(ends_s + FREE_S[0], span.end_s)
    mark = Mark(odds.begins_s, ends_s, free_s=max(end_s - ends_s, 0.0))
    marked = marked_span(mark, control.cut(*mark.reach))
    return replace(marked, end_s=end_s, closed_by=span.closed_by) if marked.steps else span


def _is_swept(maneuver: Maneuver) -> bool:
    """Return whether the autopilot reported that its SystemID moved a control."""
    return maneuver.span.closed_by == SWEPT


def _is_on_ground(maneuver: Maneuver) -> bool:
    airspeed = maneuver.channels.get("airspeed")
    if airspeed is None or len(airspeed) == 0:
        return False
    typical = float(np.median(airspeed.y))
    if typical != 0.0:
        return typical < SLOWEST_FLIGHT_M_S
    # An aircraft without an air speed sensor also sends exactly zero.
    q = maneuver.channels.get("q")
    return q is not None and len(q) > 0 and 0.5 * float(np.ptp(q.y)) < radians(LEAST_PITCH_RATE_DEG_S)
