"""Movements of the elevator during other flying: climbs, turns, changes of speed.

A test input begins abruptly, and an unusable test input is refused with a remedy. A slow movement outside the
model's limits is no test, but other flying.
"""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.steady_speed import speed_before
from advisor.process.arrays import FloatArray
from advisor.words.digits import distinct_texts


@dataclass(frozen=True, slots=True)
class Loop:
    """Channels of one control and of its response, with their names in sentences."""

    control: str
    """Channel of the deflection."""
    rate: str
    """Channel of the angular rate that responds."""
    angle: str
    """Channel of the integrated angle; empty if no angle is measured."""
    rate_said: str


PITCH = Loop("elevator", "q", "theta", "pitch rate")
ROLL = Loop("aileron", "p", "bank", "roll rate")
YAW = Loop("rudder", "r", "", "yaw rate")


OTHER_CONTROLS_DEG = 5.0
"""Largest motion of aileron and rudder during a pitch test, half of the range, deg."""
THROTTLE_PERCENT = 15.0
"""Largest motion of the throttle during a pitch test, % of its range."""
EDGE_S = 0.2
"""Length over which the elevator's motion is measured, s: half of the slowest hand-flown edge."""
_ABRUPT = 0.5
"""Least motion over ``EDGE_S`` of an abrupt movement, as a share of its amplitude. Recorded hand-flown steps
have at least 0.95, and a jet's step at 10 Hz has 0.37."""
_SLOWEST = 1.1
"""Largest ratio of two sampling intervals to ``EDGE_S`` at which an abrupt step is visible. The ratio
includes 10 % for jitter."""
_THROUGHOUT = 0.75
"""Share of a movement outside a limit that counts as the whole movement. The aircraft enters a turn from
level flight while the control moves."""


def flown_elsewhere(maneuver: Maneuver, limits: Limits) -> str | None:
    """Return in words how a slow movement was outside the model's limits; None for any other movement."""
    return None if _is_abrupt(maneuver) else next(_outside(maneuver, limits), None)


def motion_of(maneuver: Maneuver, from_s: float, to_s: float) -> FloatArray:
    """Return the elevator's motion over ``EDGE_S``, rad, at each of its stamps between two times."""
    elevator = maneuver.channels["elevator"]
    moved = np.abs(elevator.y - np.interp(elevator.t - EDGE_S, elevator.t, elevator.y))
    return moved[(elevator.t >= from_s) & (elevator.t <= to_s)]


def _is_abrupt(maneuver: Maneuver) -> bool:
    """Return whether the elevator moves abruptly, or has too few samples to show this."""
    span, elevator = maneuver.span, maneuver.channels["elevator"]
    if len(elevator) < 2 or 2.0 * float(np.median(np.diff(elevator.t))) > _SLOWEST * EDGE_S:
        return True
    moved = motion_of(maneuver, span.start_s, span.last_step_s + EDGE_S)
    amplitude = max((abs(level) for _, level in span.steps), default=0.0)
    return len(moved) == 0 or float(moved.max()) >= _ABRUPT * amplitude


def _outside(maneuver: Maneuver, limits: Limits) -> Iterator[str]:
    """Yield each limit that the movement exceeds, with its number."""
    bank = np.degrees(np.abs(_within(maneuver, "bank")))
    if len(bank) and np.mean(bank > limits.bank_deg) > _THROUGHOUT:
        shown, most = distinct_texts(float(np.median(bank)), limits.bank_deg)
        yield f"at {shown} deg of bank (limit {most})"
    speed = _within(maneuver, "airspeed")
    if len(speed) > 1 and (trim := speed_before(maneuver.channels["airspeed"], maneuver.span)) > 0.0:
        off = 100.0 * np.abs(speed / trim - 1.0)
        if np.mean(off > limits.airspeed_change_percent) > _THROUGHOUT:
            shown, most = distinct_texts(float(np.median(off)), limits.airspeed_change_percent)
            yield f"at an air speed {shown} % from that before (limit {most})"
    for name in ("aileron", "rudder"):
        moved = 0.5 * float(np.degrees(np.ptp(control))) if len(control := _within(maneuver, name)) else 0.0
        if moved > OTHER_CONTROLS_DEG:
            shown, most = distinct_texts(moved, OTHER_CONTROLS_DEG)
            yield f"while the {name} moved by {shown} deg (limit {most})"
    throttle = _within(maneuver, "throttle")
    change = 100.0 * float(np.ptp(throttle)) if len(throttle) else 0.0
    if change > THROTTLE_PERCENT:
        shown, most = distinct_texts(change, THROTTLE_PERCENT)
        yield f"while the throttle moved by {shown} % (limit {most})"


def _within(maneuver: Maneuver, name: str) -> FloatArray:
    """Return the values of a channel during the movement; empty for a missing channel."""
    channel = maneuver.channels.get(name)
    return np.empty(0) if channel is None else channel.cut(maneuver.span.start_s, maneuver.span.last_step_s).y
