"""Information of a movement about the aircraft's motion, and flying by hand instead of a test input.

A pilot or an autopilot that stabilises the aircraft moves the elevator in response to its motion. Let e be
the part of the elevator that no linear feedback of q, θ and the integral of θ explains. Only e separates
cause from effect: e is the external input of closed-loop identification (Ljung, System Identification, 1999,
ch. 13). The short period gives a linear recursion of second order for q and e,

    q[k] = a1·q[k−1] + a2·q[k−2] + b0·e[k] + b1·e[k−1] + b2·e[k−2] + c + d·k + ε[k],

with means over intervals of equal length. A servo's lag distributes the effect over b0, b1 and b2. The
statistic F tests whether b0, b1 and b2 explain more than chance (Draper & Smith, Applied Regression Analysis,
1998, ch. 6). Angle of attack and acceleration are not needed.

A test input begins abruptly, and an unusable test input is refused with a remedy. A slow movement outside the
model's limits is no test, but other flying.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import inf, sqrt
from typing import Any

import numpy as np

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.steady_speed import speed_before
from advisor.flight.signals.derived_alpha import integrated
from advisor.process.arrays import FloatArray
from advisor.words.quantities import distinct_texts


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


_INPUTS = 3
"""Number of the elevator's terms in the recursion."""
_FEWEST = 14
"""Least number of intervals for the recursion with seven terms, which leaves five degrees of freedom."""
_LONGEST_S = 0.3
"""Longest interval, s: a fifth of the natural period of a slow aircraft at 0.5 Hz."""
_PER_STEP = 4.0
"""Number of intervals in the shortest step of the input. The shortest step of an input is matched to the
short period."""
_MANY = 40.0
"""Largest number of intervals in a record, if its sampling rate allows."""


@dataclass(frozen=True, slots=True)
class Excitation:
    """Effect of a control on the angular rate that responds."""

    rate: float
    """Half of the range of the angular rate, rad/s."""
    relative_error: float
    """Relative standard error of the control's effect: 1/√(3·F). The error is infinite without an effect."""
    external_error: float
    """Relative standard error for the external input alone, for a closed loop."""
    effect: float
    """Effect of the elevator on the pitch rate, b0 + b1 + b2. The sign of the effect is that of the control;
    0 if the effect is not estimated."""


def excitation(maneuver: Maneuver, loop: Loop = PITCH) -> Excitation | None:
    """Return the information of a movement about the short period.

    Parameters
    ----------
    maneuver
        Record with the channels of the control and of the rate. Without the angle channel, the integral of
        the rate is used.

    Returns
    -------
    Excitation or None
        None if the rate is missing or never changes. The error is infinite for too few samples.
    """
    elevator, q = maneuver.channels.get(loop.control), maneuver.channels.get(loop.rate)
    if elevator is None or q is None or len(elevator) < 3 or len(q) < 3 or np.ptp(q.y) == 0.0:
        return None
    start, end = max(elevator.t[0], q.t[0]), min(elevator.t[-1], q.t[-1])
    lasting = [b - a for (a, _), (b, _) in pairwise(maneuver.span.steps)]
    coarse = max(float(np.median(np.diff(elevator.t))), float(np.median(np.diff(q.t))))
    wanted = min(min(lasting, default=inf) / _PER_STEP, (end - start) / _MANY, _LONGEST_S)
    moves = 0.5 * float(np.ptp(q.y))
    edges = np.arange(start, end, max(coarse, wanted))
    if len(edges) <= _FEWEST:
        return Excitation(moves, inf, inf, 0.0)
    rate, moved = _means(edges, q.t, q.y), _means(edges, elevator.t, elevator.y - np.mean(elevator.y))
    external = _means(edges, elevator.t, _external(maneuver, loop))
    error, effect = _effect(rate, moved)
    return Excitation(moves, error, _effect(rate, external)[0], effect)


def _external(maneuver: Maneuver, loop: Loop) -> FloatArray:
    """Return the part of the elevator that no linear feedback of the motion explains, at its stamps."""
    elevator, q = maneuver.channels[loop.control], maneuver.channels[loop.rate]
    rate = np.interp(elevator.t, q.t, q.y)
    theta = maneuver.channels.get(loop.angle)
    if theta is not None and len(theta) > 2:
        pitch = np.interp(elevator.t, theta.t, theta.y)
    else:
        pitch = integrated(elevator.t, rate)
    off = pitch - np.mean(pitch)
    fed_back = [rate, off, integrated(elevator.t, off)]
    trim = [elevator.t - elevator.t[0], np.ones(len(rate))]
    return _left(np.column_stack([*fed_back, *trim]), elevator.y)


def external_share(pairs: Sequence[tuple[Any, Any]], effect: float) -> float:
    """Return the share of a control's motion that no opposing feedback of a rate explains; 1 at rest.

    Parameters
    ----------
    pairs
        Control, rad, and rate, rad/s, of each record, with their stamps. One gain serves all records.
    effect
        Moment of the control about the axis of the rate. Its sign tells which feedback opposes the rate.
    """
    moved = np.concatenate([np.empty(0), *(control.y - np.mean(control.y) for control, _ in pairs)])
    rates = [np.interp(control.t, rate.t, rate.y) for control, rate in pairs]
    turned = np.concatenate([np.empty(0), *(rate - np.mean(rate) for rate in rates)])
    opposed = max(-np.sign(effect) * float(moved @ turned), 0.0)
    size = float(moved @ moved) * float(turned @ turned)
    return 1.0 - opposed**2 / size if size > 0.0 else 1.0


def _means(edges: FloatArray, t: FloatArray, y: FloatArray) -> FloatArray:
    """Return the means of a signal over the intervals between the edges."""
    means: FloatArray = np.diff(np.interp(edges, t, integrated(t, y))) / np.diff(edges)
    return means


def _effect(q: FloatArray, elevator: FloatArray) -> tuple[float, float]:
    """Return the relative standard error of the elevator's effect, and the effect, a sum of three."""
    n = len(q) - 2
    own = np.column_stack([q[1:-1], q[:-2], np.ones(n), np.linspace(-1.0, 1.0, n)])
    full = np.column_stack([own, elevator[2:], elevator[1:-1], elevator[:-2]])
    coefficients = _fitted(full, q[2:])
    without, left = (float(rest @ rest) for rest in (_left(own, q[2:]), q[2:] - full @ coefficients))
    explained = max(0.0, without - left)
    error = sqrt(left / (n - full.shape[1]) / explained) if explained > 0.0 else inf
    return error, float(np.sum(coefficients[-_INPUTS:]))


def _left(terms: FloatArray, y: FloatArray) -> FloatArray:
    """Return the residual of a signal after least squares on the given terms."""
    return y - terms @ _fitted(terms, y)


def _fitted(terms: FloatArray, y: FloatArray) -> FloatArray:
    """Return the least-squares coefficients of the given terms."""
    size = np.maximum(np.abs(terms).max(axis=0), 1e-12)
    coefficients: FloatArray = np.linalg.lstsq(terms / size, y, rcond=None)[0] / size
    return coefficients
