"""Preparation of lateral manoeuvres for the estimation."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.added_term import AddedTerm
from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.sines import command_of
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel
from advisor.model.axes.lateral import CONTROLS, LATERAL
from advisor.oem.airspeed import airspeed
from advisor.oem.alpha_use import can_do_without, has, infer, why_left_out
from advisor.oem.axes.lateral.instruments import beta_arm_m
from advisor.oem.axes.lateral.problem import NEEDED, LateralProblem, LateralRecord, measured_by
from advisor.oem.estimate import NoEstimate
from advisor.oem.prepare import constant_speed, reference_speed, signal_of, stated_reference, too_few
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.oem.terms import means_of, recorded

_SPOKEN = {"p": "roll rate", "r": "yaw rate", "bank": "bank angle", "theta": "pitch angle", "q": "pitch rate"}


def prepare_lateral(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> LateralProblem | NoEstimate:
    """Return the estimation problem of the lateral axis, or the reason why there is none."""
    for maneuver in maneuvers:
        if (few := too_few(maneuver, _SPOKEN)) is not None:
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
    outputs = _outputs(maneuvers, aircraft)
    left_out = why_left_out(maneuvers, aircraft)
    problem = LateralProblem(
        records=tuple(
            LateralRecord(
                inputs={
                    name: signal_of(command_of(m, name)) for name in LATERAL.inputs if has(m.channels, name)
                },
                before={name: signal_of(channel) for name, channel in m.before.items()},
                outputs={name: signal_of(m.channels[name]) for name in outputs},
                airspeed=speed,
                alpha=_alpha(m, aircraft, left_out),
                theta=signal_of(m.channels["theta"]),
                q=signal_of(m.channels["q"]),
            )
            for m, speed in zip(maneuvers, flown, strict=True)
        ),
        reference_airspeed_m_s=reference,
        servos={
            name: Servo(control.lag_s or 0.0, control.delay_s or 0.0)
            for name, control in (("aileron", aircraft.aileron), ("rudder", aircraft.rudder))
        },
        beta_arm_m=beta_arm_m(aircraft) or 0.0,
        accelerometer_arm_m=aircraft.accelerometer.arm_m or 0.0,
        fixed=aircraft.estimation.held(SIDE_PARAMETERS),
    )
    terms = [term for term in aircraft.estimation.added if not term.is_of_pitch]
    return _with_terms(problem, terms, maneuvers) if terms else problem


def _with_terms(
    problem: LateralProblem, terms: Sequence[AddedTerm], maneuvers: Sequence[Maneuver]
) -> LateralProblem | NoEstimate:
    """Return the problem with the terms that the user adds, and with the signals that these need."""
    own = {*measured_by(problem.records[0]), *CONTROLS, "beta"}
    signals = recorded(maneuvers, terms, own)
    if isinstance(signals, NoEstimate):
        return signals
    records = tuple(replace(r, signals=s) for r, s in zip(problem.records, signals, strict=True))
    series = {name: [measured_by(r)[name].y for r in records] for name in measured_by(records[0])}
    series |= {name: [r.inputs[of].y for r in records if of in r.inputs] for name, of in CONTROLS.items()}
    series = {name: parts for name, parts in series.items() if parts}
    at_zero = {term.name: 0.0 for term in terms}
    return replace(problem, records=records, terms=at_zero, means=means_of(series))


def _plain_speed(maneuver: Maneuver) -> Signal | None:
    """Return the measured air speed, at least half the slowest flight speed; None for a standing aircraft."""
    channel = maneuver.channels.get("airspeed")
    if channel is None or len(channel) < 2 or not np.median(channel.y) > SLOWEST_FLIGHT_M_S:
        return None
    return Signal(channel.t, np.maximum(channel.y, 0.5 * SLOWEST_FLIGHT_M_S))


def _outputs(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> list[str]:
    """Return the names of the outputs that every manoeuvre has."""
    names = [*NEEDED]
    names += [name for name in ("a_y", "beta") if all(_moves(m, name) for m in maneuvers)]
    if "beta" in names and not all(_is_measured(m.channels["beta"], aircraft) for m in maneuvers):
        names.remove("beta")
    return names


def _is_measured(beta: Channel, aircraft: Aircraft) -> bool:
    """Return whether a vane measures the sideslip. A sideslip estimated by the autopilot does not count as
    measured.

    A stated vane position for AOA_SSA shows that the message holds vane angles.
    """
    if aircraft.beta.source != "auto":
        return aircraft.beta.source != "none"
    stated = aircraft.alpha.source == "aoa_ssa" and aircraft.alpha.vane_arm_m is not None
    return stated or beta.provenance in ("vane", "simulated")


def _moves(maneuver: Maneuver, name: str) -> bool:
    return has(maneuver.channels, name) and float(np.ptp(maneuver.channels[name].y)) > 0.0


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
