"""Classification of an elevator movement: an identifiable input, or another activity with a reason.

The shape of the movement does not matter. The criteria are whether the aircraft flew, who moved the elevator,
and how well the pitch rate shows the elevator's effect.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import degrees, isfinite, radians

import numpy as np

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.excitation import excitation
from advisor.flight.maneuvers.feedback import explained_by_feedback
from advisor.flight.maneuvers.hand_flying import EDGE_S, flown_elsewhere, motion_of
from advisor.flight.maneuvers.loop import PITCH, Loop
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.markers import SWEPT
from advisor.flight.maneuvers.movement import SMALLEST_RAD
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.flight.signals.robust import rms
from advisor.flight.vehicle.modes import closes_pitch_loop, has_an_errand, hovers, is_manual
from advisor.words.digits import distinct_texts

LEAST_PITCH_RATE_DEG_S = 1.0
"""Least pitch rate response to a test input, deg/s. Light turbulence hides smaller pitch rates. The gentlest
recorded test input has 1.3 deg/s (a jet), and a correction of another jet has 0.7 deg/s."""
LARGEST_ERROR = 0.3
"""Largest relative standard error of the elevator's effect on the pitch rate; 0.3 is significant at 2 %.
Recorded test inputs have an error of 0.01 to 0.12 in calm air, and of 0.16 in gusts of 0.5 m/s. For the
external input alone they have up to 0.21, and an attitude hold in gusts has 0.3 to 2."""
_MOSTLY = 0.5
"""Share of a movement that feedback of the motion may explain in a test input. Above one half the movement is
mostly a response to the motion. Recorded recoveries of an attitude by hand have 0.63 to 0.94. Test inputs
that restore the attitude have at most 0.35."""
_OF_ANSWERS = 0.25
"""Largest relative error for the external input alone, over the share not explained by feedback. Recoveries
by hand have values of 0.29 to 9. A recorded unstable aircraft, which always needs feedback, has 0.09, and
simulated ones have 0.1 to 1.2."""
_STANDS_OUT = 4.0
"""Least ratio of a movement's fastest motion to the root mean square of the earlier motion. By chance 2 % of
movements of 300 samples exceed four standard deviations. Hands that hold an attitude have ratios of 0.3 to
3.6, and recorded test inputs at least 10."""
_FEWEST_BEFORE = 5
"""Least number of samples before the movement for the root mean square."""
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

_WHAT = {
    "ground": "movements without flight",
    "small": "corrections",
    "elsewhere": "movements in turns, climbs and changes of speed",
    "feedback": "recoveries of the attitude",
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
    ``no_information``, ``small`` or ``unsettled``."""
    text: str
    """Sentence about the reason, with its number and limit."""

    @property
    def what(self) -> str:
        """Kind of movement in words, without numbers."""
        return _WHAT.get(self.reason, self.text)


def not_an_input(
    maneuver: Maneuver,
    on_ground: str | None = None,
    motion: Mapping[str, Channel] | None = None,
    limits: Limits | None = None,
    loop: Loop = PITCH,
    *,
    passed_over: bool = False,
) -> Because | None:
    """Return the reason why an elevator movement is no test input; None if it may be one.

    Parameters
    ----------
    maneuver
        Record of the movement. Channels ``q`` and ``airspeed`` are used if present.
    on_ground
        Other evidence that the aircraft did not fly, in words. None without such evidence.
    motion
        Channels ``q`` and ``theta`` from a time before the movement, for `explained_by_feedback`. None for
        the channels of the record.
    limits
        Limits of bank and air speed in the aircraft file. None for the usual limits.
    loop
        Control that moved, and the motion that responds. Slow movements outside the limits are sought for the
        elevator alone.
    passed_over
        Whether a script in the autopilot announces its inputs, but not this movement. In a mode with a closed
        loop the movement is then the loop's.
    """
    control = loop.control
    if on_ground is not None:
        return Because("ground", f"the {control} moved on the ground: {on_ground}")
    if _is_on_ground(maneuver):
        return Because("ground", f"the {control} moved while the aircraft did not fly")
    if hovers(maneuver.mode):
        return Because("hover", f"the {control} moved in {maneuver.mode}, where rotors carry the aircraft")
    because = _tells_nothing(maneuver, maneuver.channels if motion is None else motion, loop)
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
    return because


def _lacks_in_a_loop(maneuver: Maneuver, because: Because | None, control: str, passed_over: bool) -> str:
    """Return in words what a movement in a closed loop lacks as a test input; empty if it lacks nothing."""
    if has_an_errand(maneuver.mode):
        return " by the autopilot's own task"
    if passed_over and not _is_swept(maneuver):
        return ", and the script in the autopilot announced no input"
    if not _is_swept(maneuver) and not _is_external(maneuver, control):
        return " without the sharp steps of a test"
    return f", and {because.text.partition('; ')[0]}" if because else ""


def _tells_nothing(maneuver: Maneuver, motion: Mapping[str, Channel], loop: Loop) -> Because | None:
    """Return the reason why the rate cannot show the control's effect; None if it can, or is missing."""
    control = loop.control
    if maneuver.span.closed_by == "no rest":
        return Because("unsettled", f"the {control} never came to rest; not a test input")
    if _is_swept(maneuver) and not maneuver.span.steps:
        return Because("small", f"the {control} stood still; not a test input")
    found = excitation(maneuver, loop)
    if found is None:
        return None
    rate = degrees(found.rate)
    if found.rate < radians(LEAST_PITCH_RATE_DEG_S):
        shown, least = distinct_texts(rate, LEAST_PITCH_RATE_DEG_S, 2, "g")
        return Because(
            "small", f"a correction: the {loop.rate_said} moved by {shown} deg/s only (at least {least})"
        )
    # For an elevator moved from outside, no other evidence is needed to separate cause from effect.
    outside = is_manual(maneuver.mode) or _is_external(maneuver, control)
    error = found.relative_error if outside else found.external_error
    if error > LARGEST_ERROR:
        known = "not at all"
        if isfinite(error) and error < 1.0:
            shown, most = distinct_texts(100.0 * error, 100.0 * LARGEST_ERROR)
            known = f"to {shown} % only (limit {most})"
        return Because("no_information", f"the {control}'s effect on the {loop.rate_said} is known {known}")
    if _is_swept(maneuver):
        return None
    answers = explained_by_feedback(maneuver.span, maneuver.channels[control], motion, found.effect, loop)
    if answers > _MOSTLY and found.external_error > _OF_ANSWERS * (1.0 - answers):
        shown, most = distinct_texts(100.0 * answers, 100.0 * _MOSTLY)
        follows = f"the {control} brought the attitude back, as feedback of the motion"
        return Because("feedback", f"{follows} explains to {shown} % (limit {most}); not a test input")
    if not _stands_out(maneuver, control):
        same = f"the {control} moved no faster than in the second before"
        return Because("small", f"a correction: {same}; not a test input")
    return None


def _is_swept(maneuver: Maneuver) -> bool:
    """Return whether the autopilot reported that its SystemID moved a control."""
    return maneuver.span.closed_by == SWEPT


def _stands_out(maneuver: Maneuver, control: str) -> bool:
    """Return whether the control moves faster than before, unlike hands that continue other flying."""
    span = maneuver.span
    before = motion_of(maneuver, span.record_from_s + EDGE_S, span.start_s, control)[:-1]
    within = motion_of(maneuver, span.start_s, span.last_step_s + EDGE_S, control)
    if len(before) < _FEWEST_BEFORE or len(within) == 0:
        return True
    return float(within.max()) >= _STANDS_OUT * rms(before)


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


def _is_external(maneuver: Maneuver, control: str) -> bool:
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
