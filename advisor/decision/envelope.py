"""Completeness of a manoeuvre's data, and its agreement with the model's assumptions.

The model assumes one input, constant speed and level wings. Each check compares a measured number with its
limit, for one assumption of the model.
"""

from collections.abc import Collection, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.decision.verdict import Reason
from advisor.flight.maneuvers.excitation import OTHER_CONTROLS_DEG, THROTTLE_PERCENT
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.maneuvers.steady_speed import LEFT, speed_before
from advisor.flight.signals.record import Channel
from advisor.flight.signals.trust import distrusted
from advisor.oem.airspeed import LARGEST_DISAGREEMENT, LONGEST_LAG_S, airspeed
from advisor.oem.axis.problem import LEAST_PART
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95, clock, distinct_texts

FASTEST_CHANGE_M_S2 = 2.0 * GRAVITY_M_S2
"""Largest rate of change of the air speed in flight, m/s². The value is gravity along the path, and a drag as
large as the weight.
"""
_SIDE = 3
"""Number of samples on each side of a jump, whose medians are compared. One wild sample is no jump."""


def leaping_speed(maneuver: Maneuver, limit: float) -> list[Reason]:
    """Return a reason if the air speed jumps within one sample by more than it may change in the manoeuvre.

    Parameters
    ----------
    limit
        Largest change of the air speed in a manoeuvre, %.
    """
    channel = maneuver.channels.get("airspeed")
    if channel is None or len(channel) < 2 * _SIDE or not np.median(channel.y) > 0.0:
        return []
    level = np.median(np.lib.stride_tricks.sliding_window_view(channel.y, _SIDE), axis=1)
    jump = np.abs(level[_SIDE:] - level[:-_SIDE])
    middle_s = channel.t[1:-1]
    by_flying = FASTEST_CHANGE_M_S2 * (middle_s[_SIDE:] - middle_s[:-_SIDE])
    percent = np.where(jump > by_flying, 100.0 * jump / speed_before(channel, maneuver.span), 0.0)
    k = int(np.argmax(percent))
    if not percent[k] > limit:
        return []
    before, after = distinct_texts(float(level[k]), float(level[k + _SIDE]), 1)
    at = clock(float(channel.t[k + _SIDE]))
    text = (
        f"air speed jumps from {before} to {after} m/s within one sample at {at}, "
        f"by {percent[k]:.0f} % (limit {limit:.0f}); check which air speed sensor flew, and its tube"
    )
    return [Reason("airspeed_jump", text, float(percent[k]), limit, by_instrument=True)]


def is_speed_carried(maneuver: Maneuver) -> bool:
    """Return whether the integral of the accelerometers gives the air speed with a small error throughout.

    The sensor gives level and drift of the integral. Their error grows with the distance from the sensor's
    samples. The sensor is filtered: its error is renewed once in ``LONGEST_LAG_S``, not with each sample.
    """
    integrated = airspeed(maneuver.channels)
    if integrated is None or not integrated.smooth:
        return False
    sensor = maneuver.channels["airspeed"]
    sampled = sensor.t - integrated.lag_s
    std = float(np.std(sensor.y - integrated.signal.at(sampled)))
    independent = max(1.0, float(np.ptp(sampled)) / LONGEST_LAG_S)
    ends = integrated.signal.t[[0, -1]] - float(np.mean(sampled))
    largest = std * np.sqrt((1.0 + np.max(ends**2) / float(np.var(sampled))) / independent)
    return bool(NORMAL_95 * largest <= LARGEST_DISAGREEMENT * float(np.mean(sensor.y)))


SAMPLES_PER_PERIOD = 8.0
"""Least number of samples of elevator and pitch rate per natural period. An aircraft of 2 rad/s needs 2.6 Hz,
one of 9 rad/s needs 11 Hz. With fewer samples the input is unknown, and no interval contains that error."""
_LONGEST_GAP = (0.3, 0.2, 1.0)
"""Longest gap in a channel, as a fraction of the natural period, and the least and greatest value of this
limit, s.
"""
_SHORTEST_FREE = 0.75
"""Least duration of the free response, in natural periods. The damping can be determined only from most of
one oscillation."""
_SHORTEST_STEP = 0.15
"""Least duration of the shortest step, in natural periods. A servo smooths shorter steps of the elevator."""
_CUT_SHORT_BY = {
    "gap": ("the telemetry breaks off", "check the link"),
    "end of log": ("the recording ends", "let the recording run on for some seconds"),
    "mode change": ("the mode changes", "stay in the mode until the motion has died down"),
}
"""Cause and remedy of a record that was cut short by something other than the pilot."""
_ASSUMED_STROKE_DEG = 25.0
"""Assumed full travel of the elevator without a calibration, deg."""


def incomplete(
    maneuver: Maneuver, needed: Sequence[str], period_s: float, counted: Collection[str]
) -> list[Reason]:
    """Return reasons for incomplete data: missing, faulty or slow channels, and gaps.

    Parameters
    ----------
    needed
        Channels without which no manoeuvre can be judged.
    period_s
        Natural period of the motion, estimated or assumed, s.
    counted
        Outputs that the estimate used. The model also reads the pitch angle and the air speed. Gaps in other
        channels do no harm.
    """
    missing = [name for name in needed if name not in maneuver.channels]
    if missing:
        text = f"no {' and no '.join(missing)} during the manoeuvre; check the recording and fly it again"
        return [Reason("missing", text, float(len(missing)), 0.0)]
    wrong = [d for d in distrusted(maneuver.channels) if d.stops]
    if wrong:
        return [Reason(d.code, f"{d.text}; {d.fix}", d.value, 0.0) for d in wrong]
    read = {*needed, *counted, "theta", *(() if is_speed_carried(maneuver) else ("airspeed",))}
    used = [maneuver.channels[name] for name in read if name in maneuver.channels]
    return [
        *too_slow([maneuver.channels[name] for name in needed], period_s),
        *with_gap(used, maneuver, period_s),
    ]


def not_heard(maneuver: Maneuver) -> Reason:
    """Return the reason against a record with a gap while the advisor was down."""
    text = f"{maneuver.missed_s:.1f} s are missing: the advisor was down; fly it again"
    return Reason("advisor_down", text, maneuver.missed_s, 0.0)


def leapt(maneuver: Maneuver) -> Reason:
    """Return the reason against a record in which the vehicle's stamps jump."""
    text = f"the stamps leap by {maneuver.leapt_s / 3600.0:.1f} h; check the vehicle's clock, fly it again"
    return Reason("clock", text, maneuver.leapt_s, 0.0)


def too_quick(maneuver: Maneuver, period_s: float) -> list[Reason]:
    """Return a reason if steps are too short for the servo and the aircraft."""
    onsets = [onset for onset, _ in maneuver.span.steps]
    if len(onsets) < 2 or maneuver.span.kind == "multisine":
        return []
    shortest, least = float(np.min(np.diff(onsets))), _SHORTEST_STEP * period_s
    if shortest >= least:
        return []
    shown, limit = distinct_texts(shortest, least, 2)
    text = f"steps too short, {shown} s (at least {limit}); hold each about {0.4 * period_s:.1f} s"
    return [Reason("steps", text, shortest, least)]


def flown(maneuver: Maneuver, name: str) -> FloatArray:
    """Return the values of a channel from the first step to the end; empty for a missing channel."""
    channel = maneuver.channels.get(name)
    if channel is None:
        return np.empty(0)
    return channel.cut(maneuver.span.start_s, maneuver.span.end_s).y


def needed_hz(period_s: float) -> float:
    """Return the least rate of a channel, Hz, for a motion of this period, s."""
    return SAMPLES_PER_PERIOD / period_s


def too_slow(channels: Sequence[Channel], period_s: float) -> list[Reason]:
    """Return a reason for each channel that arrives too slowly for a motion of this period, s."""
    least_hz = needed_hz(period_s)
    reasons = []
    for c in channels:
        if not c.rate_hz >= least_hz:
            rate, needed = distinct_texts(c.rate_hz, least_hz, 1)
            text = (
                f"{c.name} arrived at {rate} Hz (this aircraft needs {needed}); "
                f"raise the rate of {c.name}; advisor doctor names the setting"
            )
            reasons.append(Reason("rate", text, c.rate_hz, least_hz))
    return reasons


def with_gap(channels: Sequence[Channel], maneuver: Maneuver, period_s: float) -> list[Reason]:
    """Return a reason if the longest gap of the given channels in a manoeuvre is too long."""
    share, least, most = _LONGEST_GAP
    reasons = []
    for c in channels:
        limit = max(float(np.clip(share * period_s, least, most)), 3.5 / c.rate_hz if c.rate_hz > 0 else 0.0)
        edges = (maneuver.span.record_from_s, *c.t.tolist(), maneuver.span.end_s)
        gap = float(np.max(np.diff(edges)))
        text = "{} s of " + c.name + " are missing (limit {}); check the recording, fly it again"
        reasons += above("gap", gap, limit, text, 1)
    return sorted(reasons, key=lambda reason: (-reason.value, reason.text))[:1]


def shortest_response_s(period_s: float) -> float:
    """Return the least duration of the free response of a motion with this natural period, s."""
    return _SHORTEST_FREE * period_s


def short_response(maneuver: Maneuver, period_s: float) -> list[Reason]:
    """Return a reason if the record ends before the motion has decayed."""
    if maneuver.span.closed_by == LEFT:
        return _left_too_soon(maneuver)
    if is_broken_off(maneuver.span):
        what, mend = _CUT_SHORT_BY[maneuver.span.closed_by]
        return [Reason("aborted", f"{what} before the input is over; {mend}", 0.0, 1.0)]
    free, least = maneuver.span.end_s - maneuver.span.last_step_s, shortest_response_s(period_s)
    if free >= least:
        return []
    shown, limit = distinct_texts(free, least, 1)
    what, mend = _CUT_SHORT_BY.get(maneuver.span.closed_by, ("", "stick still after the last step"))
    cause = f": {what} there" if what else ""
    text = f"free response too short, {shown} s (at least {limit}){cause}; {mend}"
    return [Reason("free_response", text, free, least)]


def _left_too_soon(maneuver: Maneuver) -> list[Reason]:
    """Return a reason if the record ends too early because the air speed changed."""
    lasted = maneuver.span.end_s - maneuver.span.start_s
    text = f"air speed left the model after {lasted:.1f} s, too soon; smaller steps, from steady speed"
    return [Reason("airspeed", text, lasted, maneuver.span.end_s - maneuver.span.record_from_s)]


def is_broken_off(span: Span) -> bool:
    """Return whether the record ended while the control was still away from trim."""
    return span.closed_by in _CUT_SHORT_BY and bool(span.steps) and span.steps[-1][1] != 0.0


def banked(maneuver: Maneuver, limit: float, mend: str = "fly it wings level") -> list[Reason]:
    """Return a reason if the bank exceeds its limit, deg."""
    bank = float(np.degrees(np.max(np.abs(flown(maneuver, "bank")), initial=0.0)))
    return above("bank", bank, limit, "bank reached {} deg (limit {}); " + mend)


def above(code: str, value: float, limit: float, text: str, digits: int = 0) -> list[Reason]:
    """Return a reason if a value exceeds its limit. The text contains ``{}`` in place of value and limit."""
    if value <= limit:
        return []
    return [Reason(code, text.format(*distinct_texts(value, limit, digits)), value, limit)]


def changed_speed(maneuver: Maneuver, aircraft: Aircraft) -> list[Reason]:
    """Return a reason if the air speed deviated too far from its value before the first step. Another reason
    often causes the change of speed."""
    limit = aircraft.limits.airspeed_change_percent
    speed = flown(maneuver, "airspeed")
    if len(speed) < 2 or not np.median(maneuver.channels["airspeed"].y) > 0.0:
        return []
    trim = speed_before(maneuver.channels["airspeed"], maneuver.span)
    # The second largest deviation: one wild reading of the air speed is no change of speed.
    change = 100.0 * float(np.sort(np.abs(speed / trim - 1.0))[-2:][0])
    text = "air speed changed by {} % (limit {}); smaller steps, from steady speed"
    return above("airspeed", change, limit, text)


def steep(maneuver: Maneuver, limit: float | None) -> list[Reason]:
    """Return a reason if the angle of attack exceeds its limit, deg."""
    alpha = float(np.degrees(np.max(np.abs(flown(maneuver, "alpha")), initial=0.0)))
    text = "angle of attack reached {} deg (limit {}); use less stick"
    return [] if limit is None else above("alpha", alpha, limit, text, 1)


def saturated(maneuver: Maneuver, control: str, ends_deg: tuple[float, float] | None) -> list[Reason]:
    """Return a reason if a control stays at an end of its travel, deg; None means ±25 deg."""
    ends = ends_deg or (-_ASSUMED_STROKE_DEG, _ASSUMED_STROKE_DEG)
    deflection = np.round(np.degrees(flown(maneuver, control)), 6)
    stuck = (deflection <= min(ends)) | (deflection >= max(ends))
    share = 100.0 * float(np.mean(stuck)) if len(stuck) else 0.0
    if np.count_nonzero(stuck) < 2:
        return []
    shown, most = distinct_texts(share, 0.0)
    text = f"{control} at the end of its travel for {shown} % of the time (limit {most}); use less stick"
    return [Reason("saturation", text, share, 0.0)]


def other_controls(maneuver: Maneuver, names: Sequence[str], mend: str) -> list[Reason]:
    """Return a reason for each given control that moved too much."""
    reasons = []
    for name in names:
        moved = _range_deg(maneuver, name) / 2.0
        reasons += above(name, moved, OTHER_CONTROLS_DEG, name + " moved by {} deg (limit {}); " + mend)
    return reasons


def _range_deg(maneuver: Maneuver, name: str) -> float:
    """Return the range of a control during the manoeuvre, deg; 0 for an unrecorded control."""
    y = flown(maneuver, name)
    return float(np.degrees(np.ptp(y))) if len(y) else 0.0


def moved_controls(maneuver: Maneuver) -> tuple[str, ...]:
    """Return the controls that move as a part of the test, and not only with the motion."""
    ranges = {name: _range_deg(maneuver, name) for name in ("elevator", "aileron", "rudder")}
    least = LEAST_PART * max(ranges.values())
    return tuple(name for name, moved in ranges.items() if moved >= least > 0.0)


def moved_at_once(maneuver: Maneuver) -> bool:
    """Return whether the elevator moves together with aileron or rudder, each as a part of the test."""
    moved = moved_controls(maneuver)
    return "elevator" in moved and len(moved) > 1


def follows_motion(maneuver: Maneuver, control: str, others: Sequence[str]) -> list[Reason]:
    """Return a reason if a control moves far less than another control, so that it only follows
    the motion.
    """
    moved, *beside = (_range_deg(maneuver, name) for name in (control, *others))
    larger = others[int(np.argmax(beside))]
    if moved >= LEAST_PART * max(beside):
        return []
    shown, least = distinct_texts(moved, LEAST_PART * max(beside), 1)
    text = f"{control} moved by {shown} deg next to the {larger} (at least {least}); move the {control} alone"
    return [Reason("follows", text, moved, LEAST_PART * max(beside))]


def throttled(maneuver: Maneuver) -> list[Reason]:
    """Return a reason if the throttle moved too much."""
    throttle = flown(maneuver, "throttle")
    change = 100.0 * float(np.ptp(throttle)) if len(throttle) else 0.0
    text = "throttle moved by {} % (limit {}); leave the throttle where it is"
    return above("throttle", change, THROTTLE_PERCENT, text)
