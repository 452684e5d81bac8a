"""Preparation of manoeuvres for the estimation along an axis."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.added_term import AddedTerm
from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.sines import command_of
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.model.axis import Axis
from advisor.oem.airspeed import airspeed
from advisor.oem.alpha_use import can_do_without, has, infer, why_left_out
from advisor.oem.axis.parameter import stated_arm_m
from advisor.oem.axis.problem import TERM, AxisProblem, AxisRecord
from advisor.oem.estimate import NoEstimate
from advisor.oem.prepare import constant_speed, reference_speed, signal_of, stated_reference, too_few
from advisor.oem.rows import Signal
from advisor.oem.terms import means_of, recorded


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
    outputs, left_out = _outputs(axis, maneuvers, aircraft), why_left_out(maneuvers, aircraft)
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
                before={name: signal_of(channel) for name, channel in m.before.items()},
                outputs={name: signal_of(m.channels[name]) for name in outputs},
                given={name: _given(name, m, speed, aircraft, left_out) for name in axis.given},
            )
            for m, speed in zip(maneuvers, flown, strict=True)
        ),
        reference_airspeed_m_s=reference,
        values=values,
        fixed=aircraft.estimation.held(axis.names.reported),
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
    records = tuple(replace(r, signals=s) for r, s in zip(problem.records, signals, strict=True))
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


def _outputs(axis: Axis, maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> list[str]:
    """Return the names of the outputs that every manoeuvre has."""
    optional = [name for name in axis.outputs if name not in axis.needed]
    names = [*axis.needed, *(name for name in optional if all(_moves(m, name) for m in maneuvers))]
    if axis.hidden in names and not all(
        _is_measured(axis.hidden, m.channels[axis.hidden], aircraft) for m in maneuvers
    ):
        names.remove(axis.hidden)
    return names


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


def _given(name: str, maneuver: Maneuver, speed: Signal, aircraft: Aircraft, left_out: str) -> Signal:
    """Return a known signal of a manoeuvre, with the air speed as prepared."""
    if name == "airspeed":
        return speed
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
    theta = maneuver.channels["theta"]
    return Signal(theta.t[[0, -1]], np.full(2, float(np.mean(theta.y))))
