"""Preparation of manoeuvres for the estimation along an axis."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.added_term import AddedTerm
from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.stepped_input import command_of
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel, renewed
from advisor.model.axis import Axis
from advisor.oem.airspeed import airspeed
from advisor.oem.alpha_use import FEWEST_SAMPLES, can_do_without, has, infer, why_left_out
from advisor.oem.axis.parameter import stated_arm_m
from advisor.oem.axis.problem import TERM, AxisProblem, AxisRecord
from advisor.oem.estimate import NoEstimate
from advisor.oem.prepare import (
    constant_speed,
    reference_speed,
    sideslip_turn,
    signal_of,
    stated_reference,
    too_few,
)
from advisor.oem.rows import Signal
from advisor.oem.terms import means_of, recorded

COMPUTED_HZ = 22.0
"""Prior: rate below which an angle of attack may be ArduPilot's own, which is renewed at most 20 times per
second, Hz."""


def prepare(axis: Axis, maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> AxisProblem | NoEstimate:
    """Return the estimation problem of an axis, or the reason why there is none."""
    for maneuver in maneuvers:
        if (few := too_few(maneuver, axis.words)) is not None:
            return few
    measured = [airspeed(m.channels) for m in maneuvers]
    speeds = [
        speed_read.signal
        if speed_read is not None
        else _plain_speed(m) or constant_speed(m, aircraft.stated_airspeed_m_s)
        for speed_read, m in zip(measured, maneuvers, strict=True)
    ]
    flown = [speed for speed in speeds if speed is not None]
    if len(flown) < len(maneuvers):
        return NoEstimate(
            "no_airspeed",
            "No air speed is known, and the turn rate of the path depends on it: set airspeed_m_s.",
        )
    reference = reference_speed(
        flown,
        stated_reference(aircraft, maneuvers),
        all(speed_read is not None and speed_read.smooth for speed_read in measured),
    )
    left_out = why_left_out(maneuvers, aircraft)
    outputs = _outputs(axis, maneuvers, aircraft, left_out)
    given = [
        {name: _given(axis, name, m, speed, aircraft, left_out) for name in axis.given}
        for m, speed in zip(maneuvers, flown, strict=True)
    ]
    values = {(axis.force, "arm_m"): aircraft.accelerometer.arm_m or 0.0} if axis.force else {}
    values |= {(name, "arm_m"): stated_arm_m(name, aircraft) or 0.0 for name in axis.arms}
    for name in axis.inputs:
        control = getattr(aircraft, name)
        values |= {(name, "lag_s"): control.lag_s or 0.0, (name, "delay_s"): control.delay_s or 0.0}
    problem = AxisProblem(
        axis=axis,
        records=tuple(
            AxisRecord(
                inputs={
                    name: signal_of(command_of(m, name)) for name in axis.inputs if has(m.channels, name)
                },
                before={name: signal_of(c) for name, c in m.before.items() if name in axis.inputs},
                outputs=_read(axis, outputs, m, signals),
                given=signals,
                signals=_driving(axis, m),
            )
            for m, signals in zip(maneuvers, given, strict=True)
        ),
        reference_airspeed_m_s=reference,
        values=values,
        fixed=aircraft.estimation.held(axis.names.reported),
        is_computed=bool(axis.computed)
        and axis.hidden in outputs
        and all(_is_computed(m.channels[axis.hidden]) for m in maneuvers),
    )
    terms = [term for term in aircraft.estimation.added if term.equation in axis.letters]
    return _with_terms(problem, terms, maneuvers) if terms else problem


def _with_terms(
    problem: AxisProblem, terms: Sequence[AddedTerm], maneuvers: Sequence[Maneuver]
) -> AxisProblem | NoEstimate:
    """Return the problem with the terms that the user adds, and with the signals that these need."""
    axis = problem.axis
    own = {*problem.spoken(problem.records[0]), *axis.controls, axis.hidden}
    signals = recorded(maneuvers, terms, own)
    if isinstance(signals, NoEstimate):
        return signals
    pairs = zip(problem.records, signals, strict=True)
    records = tuple(replace(r, signals={**r.signals, **s}) for r, s in pairs)
    series = {name: [problem.spoken(r)[name].y for r in records] for name in problem.spoken(records[0])}
    series |= {n: [r.inputs[of].y for r in records if of in r.inputs] for n, of in axis.controls.items()}
    series = {name: parts for name, parts in series.items() if parts}
    values = {**problem.values, **{(TERM, term.name): 0.0 for term in terms}}
    return replace(problem, records=records, values=values, means=means_of(series))


def _plain_speed(maneuver: Maneuver) -> Signal | None:
    """Return the measured air speed, at least half the slowest flight speed; None for a standing aircraft."""
    channel = maneuver.channels.get("airspeed")
    if channel is None or len(channel) < 2 or not np.median(channel.y) > SLOWEST_FLIGHT_M_S:
        return None
    return Signal(channel.t, np.maximum(channel.y, 0.5 * SLOWEST_FLIGHT_M_S))


def _outputs(axis: Axis, maneuvers: Sequence[Maneuver], aircraft: Aircraft, left_out: str) -> list[str]:
    """Return the names of the outputs that every manoeuvre has.

    An angle that the autopilot computes is an output where the axis knows the instrument of such an angle.
    """
    optional = [name for name in axis.outputs if name not in axis.needed]
    names = [*axis.needed, *(name for name in optional if all(_moves(m, name) for m in maneuvers))]
    if axis.hidden in names:
        angles = [m.channels[axis.hidden] for m in maneuvers]
        used = (
            not left_out and all(angle.provenance != "inferred" for angle in angles)
            if axis.computed
            else all(_is_measured(axis.hidden, angle, aircraft) for angle in angles)
        )
        if not used:
            names.remove(axis.hidden)
    return names


def _read(
    axis: Axis, outputs: Sequence[str], maneuver: Maneuver, given: Mapping[str, Signal]
) -> dict[str, Signal]:
    """Return the measured outputs, with the force turned into the direction across the path."""
    channels = maneuver.channels
    read = {name: signal_of(channels[name]) for name in outputs}
    if axis.body and axis.force in read and has(channels, axis.body):
        t, y = read[axis.force]
        angle, along = given[axis.hidden].at(t), signal_of(channels[axis.body]).at(t)
        read[axis.force] = Signal(t, y * np.cos(angle) - along * np.sin(angle))
    if axis.computed and axis.hidden in read:
        # Values repeated at new stamps would be used several times, and late.
        read[axis.hidden] = Signal(*renewed(*read[axis.hidden], FEWEST_SAMPLES))
    return read


def _driving(axis: Axis, maneuver: Maneuver) -> dict[str, Signal]:
    """Return the known signals that drive the rates, each relative to its begin."""
    names = {name for moment in axis.moments.values() for name in moment.signals}
    signals = {n: signal_of(maneuver.channels[n]) for n in names if has(maneuver.channels, n)}
    return {
        n: Signal(s.t, s.y - float(np.mean(s.y[:FEWEST_SAMPLES])) if n == "throttle" else s.y)
        for n, s in signals.items()
    }


def _is_computed(angle: Channel) -> bool:
    """Return whether an autopilot computes an angle from its inertial sensors.

    ArduPilot marks every angle as derived, and renews its own estimate at most 20 times per second.
    """
    if angle.provenance not in ("derived", "simulated"):
        return False
    t, _ = renewed(angle.t, angle.y)
    return len(t) / (angle.t[-1] - angle.t[0]) < COMPUTED_HZ or not angle.source.startswith("AOA_SSA")


def _is_measured(name: str, channel: Channel, aircraft: Aircraft) -> bool:
    """Return whether a vane measures an angle; an angle that the autopilot estimates does not count.

    A stated vane position for AOA_SSA shows that the message holds vane angles.
    """
    source = getattr(aircraft, name).source
    if source != "auto":
        return bool(source != "none")
    stated = aircraft.alpha.source == "aoa_ssa" and aircraft.alpha.vane_arm_m is not None
    return stated or channel.provenance in ("vane", "simulated")


def _moves(maneuver: Maneuver, name: str) -> bool:
    return has(maneuver.channels, name) and float(np.ptp(maneuver.channels[name].y)) > 0.0


def _given(
    axis: Axis, name: str, maneuver: Maneuver, speed: Signal, aircraft: Aircraft, left_out: str
) -> Signal:
    """Return a known signal of a manoeuvre, with the air speed as prepared."""
    if name == "airspeed":
        return speed
    if name in axis.optional:
        alpha = _alpha(maneuver, aircraft, left_out) if name == "slip" else None
        course = None if alpha is None else sideslip_turn(maneuver.channels, alpha)
        if alpha is None and has(maneuver.channels, name):
            course = signal_of(maneuver.channels[name])
        return Signal(speed.t[[0, -1]], np.zeros(2)) if course is None else course
    return _alpha(maneuver, aircraft, left_out) if name == "alpha" else signal_of(maneuver.channels[name])


def _alpha(maneuver: Maneuver, aircraft: Aircraft, left_out: str) -> Signal:
    """Return the angle of attack: measured, from the motion, or that of level flight at the mean attitude."""
    channel: Channel | None = None
    if not left_out and has(maneuver.channels, "alpha"):
        channel = maneuver.channels["alpha"]
    elif can_do_without(maneuver, aircraft):
        channel = infer(maneuver, aircraft)
    elif has(maneuver.channels, "alpha"):
        channel = maneuver.channels["alpha"]
    if channel is not None:
        return signal_of(channel)
    theta = maneuver.channels.get("theta", maneuver.channels["q"])
    return Signal(theta.t[[0, -1]], np.full(2, float(np.mean(theta.y))))
