"""Preparation of manoeuvres for the estimation, with the aircraft file."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.atmosphere import AirData
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.maneuvers.stepped_input import command_of
from advisor.flight.signals.derived_alpha import channel_at, gravity_in_plane
from advisor.flight.signals.record import Channel, renewed
from advisor.flight.signals.track import SEA_LEVEL_DENSITY_KG_M3, true_over_read
from advisor.oem.airspeed import Airspeed, airspeed
from advisor.oem.alpha_use import FEWEST_SAMPLES, can_do_without, infer, lacking, why_left_out
from advisor.oem.alpha_use import has as _has
from advisor.oem.coefficients import scales
from advisor.oem.estimate import NoEstimate
from advisor.oem.instruments import COUPLING, as_found
from advisor.oem.known_instruments import found_of
from advisor.oem.lost_input import restored
from advisor.oem.prior import COEFFICIENT_STD
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from advisor.oem.terms import means_of, recorded

OUTPUTS = ("alpha", "q", "a_z")
"""Outputs that the fit compares with the measurement. The attitude is the integral of the pitch rate, so its
residual contains every error of model and air. As an output the attitude would outweigh the others and move
M_α by 5 to 10 % on real flights."""
SPEED_CHANGE = 0.03
"""Relative change of the air speed above which derivatives scale with a measured air speed."""
SMOOTH_SPEED_CHANGE = 0.01
"""Relative change of an air speed from the accelerometers above which derivatives scale with it. Noise cannot
cause a change of this size."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """Estimation problem, with facts about its preparation."""

    problem: OutputErrorProblem
    renewed_hz: float
    """Renewal rate of the angle of attack in the slowest manoeuvre, Hz; NaN if no angle is used."""
    alpha_held: bool
    """Whether the angle of attack repeats old values at new stamps."""
    alpha_left_out: str
    """Reason why no measured angle of attack is used, in words; empty if one is used."""
    missing: tuple[str, ...]
    """Outputs that not every manoeuvre has: a_z, or none."""
    airspeed_lag_s: float
    """Mean delay of the air speed sensor over the manoeuvres, s."""
    airspeed_m_s: float | None
    """Mean measured air speed over the manoeuvres, m/s."""


def prepare(maneuvers: Sequence[Maneuver], aircraft: Aircraft) -> Prepared | NoEstimate:
    """Return the estimation problem, or the reason why there is none."""
    for maneuver in maneuvers:
        missing = _missing(maneuver)
        if missing is not None:
            return missing
    alpha_left_out = why_left_out(maneuvers, aircraft)
    if alpha_left_out and not all(can_do_without(m, aircraft) for m in maneuvers):
        if not all(_has(m.channels, "alpha") for m in maneuvers):
            return _no_alpha(maneuvers, aircraft, alpha_left_out)
        alpha_left_out = ""
    if alpha_left_out:
        return _without_alpha(maneuvers, aircraft, alpha_left_out)
    usable = [name for name in OUTPUTS if name != "alpha" and all(_has(m.channels, name) for m in maneuvers)]
    speeds = [airspeed(m.channels) for m in maneuvers]
    if any(speed is None for speed in speeds) and aircraft.airspeed_m_s is None:
        usable = [name for name in usable if name != "a_z"]
    alphas = [_renewed(signal_of(m.channels["alpha"])) for m in maneuvers]
    return _prepared(
        maneuvers,
        aircraft,
        speeds,
        [alpha for alpha, _ in alphas],
        ["alpha", *usable],
        renewed_hz=min((len(alpha.t) - 1) / float(alpha.t[-1] - alpha.t[0]) for alpha, _ in alphas),
        alpha_held=any(held for _, held in alphas),
        missing=tuple(name for name in OUTPUTS if name not in ("alpha", *usable)),
    )


def _without_alpha(maneuvers: Sequence[Maneuver], aircraft: Aircraft, why: str) -> Prepared | NoEstimate:
    """Return a problem with the angle of attack as an unmeasured state, and q and a_z as outputs."""
    inferred = [infer(m, aircraft) for m in maneuvers]
    with_alpha = [{**m.channels, "alpha": alpha} for m, alpha in zip(maneuvers, inferred, strict=True)]
    return _prepared(
        maneuvers,
        aircraft,
        [airspeed(channels) for channels in with_alpha],
        [signal_of(alpha) for alpha in inferred],
        ["q", "a_z"],
        alpha_left_out=why,
    )


def _prepared(
    maneuvers: Sequence[Maneuver],
    aircraft: Aircraft,
    speeds: Sequence[Airspeed | None],
    alphas: Sequence[Signal],
    usable: Sequence[str],
    *,
    renewed_hz: float = float("nan"),
    alpha_held: bool = False,
    alpha_left_out: str = "",
    missing: tuple[str, ...] = (),
) -> Prepared | NoEstimate:
    measured = [speed for speed in speeds if speed is not None]
    together = len(measured) == len(maneuvers)
    signals = [
        speed.signal if speed is not None and together else constant_speed(maneuver, aircraft.airspeed_m_s)
        for maneuver, speed in zip(maneuvers, speeds, strict=True)
    ]
    flown = [signal for signal in signals if signal is not None]
    flown_m_s = float(np.mean([signal.y.mean() for signal in flown])) if flown else None
    problem = OutputErrorProblem(
        records=tuple(
            _record(maneuver, signal, alpha, usable)
            for maneuver, signal, alpha in zip(maneuvers, signals, alphas, strict=True)
        ),
        reference_airspeed_m_s=reference_speed(
            flown, stated_reference(aircraft, maneuvers), all(v.smooth for v in measured)
        )
        if together
        else None,
        servo=Servo(aircraft.elevator.lag_s or 0.0, aircraft.elevator.delay_s or 0.0),
        vane_arm_m=(aircraft.alpha.vane_arm_m or 0.0) if flown else 0.0,
        accelerometer_arm_m=aircraft.accelerometer.arm_m or 0.0,
        per_coefficient=_per_coefficient(aircraft, flown_m_s),
        alpha_is_computed="alpha" in usable and all(_is_computed(m.channels["alpha"]) for m in maneuvers),
    )
    structured = _structured(problem, aircraft, maneuvers)
    if isinstance(structured, NoEstimate):
        return structured
    return Prepared(
        problem=restored(as_found(structured, found_of(aircraft))),
        renewed_hz=renewed_hz,
        alpha_held=alpha_held,
        alpha_left_out=alpha_left_out,
        missing=missing,
        airspeed_lag_s=float(np.mean([speed.lag_s for speed in measured])) if measured else 0.0,
        airspeed_m_s=flown_m_s,
    )


def _structured(
    problem: OutputErrorProblem, aircraft: Aircraft, maneuvers: Sequence[Maneuver]
) -> OutputErrorProblem | NoEstimate:
    """Return the problem with held parameters, and with the terms of inputs at once and of the user."""
    fixed = aircraft.estimation.held(PARAMETERS)
    terms = [term for term in aircraft.estimation.added if term.is_of_pitch]
    measured = all(_has(m.channels, name) for m in maneuvers for name in COUPLING.signals)
    if measured and COUPLING not in terms and any(m.span.kind == "multisine" for m in maneuvers):
        terms.append(COUPLING)
    if not terms:
        return replace(problem, fixed=fixed) if fixed else problem
    own = {"alpha", "q", "delta_e", *(["V"] if problem.records[0].airspeed is not None else [])}
    signals = recorded(maneuvers, terms, own)
    if isinstance(signals, NoEstimate):
        return signals
    records = tuple(replace(r, signals=s) for r, s in zip(problem.records, signals, strict=True))
    series = {name: [s[name].y for s in signals] for name in signals[0]}
    series |= {"alpha": [r.alpha.y for r in records], "delta_e": [r.elevator.y for r in records]}
    terms_at_zero = {term.name: 0.0 for term in terms}
    return replace(problem, records=records, fixed=fixed, terms=terms_at_zero, means=means_of(series))


def _per_coefficient(aircraft: Aircraft, airspeed_m_s: float | None) -> Mapping[str, float]:
    """Return the moment derivatives for coefficients of 1, at sea-level density."""
    air = AirData(SEA_LEVEL_DENSITY_KG_M3, "sea level", "true")
    factors = scales(airspeed_m_s, aircraft.reference, air) if airspeed_m_s else {}
    return {name: 1.0 / factor for name, factor in factors.values() if name in COEFFICIENT_STD}


def _is_computed(alpha: Channel) -> bool:
    """Return whether an angle of attack is computed, by an autopilot or a simulator."""
    return alpha.provenance in ("derived", "simulated")


def _renewed(signal: Signal) -> tuple[Signal, bool]:
    """Return the samples with a new value, and whether the channel is held between them.

    Values repeated at new stamps would be used several times, and late.
    """
    t, y = renewed(signal.t, signal.y, FEWEST_SAMPLES)
    return Signal(t, y), len(t) < len(signal.t)


def _missing(maneuver: Maneuver) -> NoEstimate | None:
    if (few := too_few(maneuver, {"elevator": "the elevator", "q": "pitch rate"})) is not None:
        return few
    if float(np.ptp(maneuver.channels["elevator"].y)) == 0.0:
        return NoEstimate("no_input", f"The elevator did not move in manoeuvre {maneuver.number}.")
    return None


def too_few(maneuver: Maneuver, spoken: Mapping[str, str]) -> NoEstimate | None:
    """Return the reason with the first channel that has too few samples; None without such a channel."""
    for name, words in spoken.items():
        if not _has(maneuver.channels, name):
            samples = len(maneuver.channels[name]) if name in maneuver.channels else 0
            text = f"Manoeuvre {maneuver.number} has {samples} samples of {words}; it takes {FEWEST_SAMPLES}."
            return NoEstimate("too_few_samples", text)
    return None


def _record(maneuver: Maneuver, speed: Signal | None, alpha: Signal, usable: Sequence[str]) -> Record:
    channels = maneuver.channels
    outputs = {"q": signal_of(channels["q"])}
    if "alpha" in usable:
        outputs = {"alpha": alpha, **outputs}
    normal = gravity = None
    if "a_z" in usable:
        outputs["a_z"] = signal_of(channels["a_z"])
    if _has(channels, "theta"):
        theta = signal_of(channels["theta"])
        bank = channel_at("bank", theta.t, channels)
        up, size = gravity_in_plane(theta.y, bank)
        normal = Signal(theta.t, size / GRAVITY_M_S2 * np.cos(up - alpha.at(theta.t)))
        gravity = Signal(theta.t, GRAVITY_M_S2 * np.cos(theta.y) * np.cos(bank))
    return Record(
        elevator=signal_of(command_of(maneuver, "elevator")),
        before=signal_of(before) if (before := maneuver.before.get("elevator")) else None,
        outputs=outputs,
        airspeed=speed,
        normal_gravity=normal,
        gravity_z=gravity,
        sideslip_turn=sideslip_turn(channels, alpha),
        inferred_alpha=None if "alpha" in usable else alpha,
    )


def sideslip_turn(channels: Mapping[str, Channel], alpha: Signal) -> Signal | None:
    """Return the rate of α by rolling in sideslip, rad/s; None without a sideslip or a roll rate.

    The level of a computed sideslip depends on the estimated wind, so only its changes are used.
    """
    if not all(_has(channels, name) for name in ("beta", "p")):
        return None
    t, p = signal_of(channels["p"])
    beta, angle = signal_of(channels["beta"]), alpha.at(t)
    slip = beta.at(t) - (float(np.mean(beta.y)) if _is_computed(channels["beta"]) else 0.0)
    return Signal(t, -np.tan(slip) * (p * np.cos(angle) + channel_at("r", t, channels) * np.sin(angle)))


def _no_alpha(maneuvers: Sequence[Maneuver], aircraft: Aircraft, why: str) -> NoEstimate:
    """Return the reason why there is neither an angle of attack nor a replacement."""
    absent = sorted({name for m in maneuvers for name in lacking(m, aircraft)})
    text = f"{why}, and the motion cannot replace it: no {', no '.join(absent)} in the record."
    return NoEstimate("no_alpha", text[0].upper() + text[1:])


def constant_speed(maneuver: Maneuver, speed: float | None) -> Signal | None:
    """Return a constant air speed over a manoeuvre; None without a speed."""
    if speed is None:
        return None
    return Signal(maneuver.channels["q"].t[[0, -1]], np.array([speed, speed]))


def stated_reference(aircraft: Aircraft, maneuvers: Sequence[Maneuver]) -> float | None:
    """Return the true air speed at the file's reference speed. The file states the speed that the sensor
    reads.
    """
    read = aircraft.reference_airspeed_m_s
    return None if read is None else read * true_over_read(m.channels for m in maneuvers)


def reference_speed(speeds: Sequence[Signal], stated: float | None, smooth: bool) -> float | None:
    """Return the reference air speed; None if the speed hardly changes."""
    together = np.concatenate([speed.y for speed in speeds])
    if np.min(together) <= 0.0:
        return None
    reference = stated or float(np.mean(together))
    enough = SMOOTH_SPEED_CHANGE if smooth else SPEED_CHANGE
    moved = float(np.max(together) - np.min(together)) > enough * reference
    differs = abs(float(np.mean(together)) / reference - 1.0) > enough / 2.0
    return reference if moved or differs else None


def signal_of(channel: Channel) -> Signal:
    """Return the finite samples of a channel, each at the time of its measurement."""
    keep = np.isfinite(channel.y)
    return Signal(np.asarray(channel.t[keep], float) - channel.delay_s, np.asarray(channel.y[keep], float))
