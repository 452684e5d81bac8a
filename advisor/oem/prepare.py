"""From manoeuvres and the aircraft file to the estimator's problem."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft import Aircraft
from advisor.flight.maneuver import Maneuver
from advisor.flight.motion import integrated
from advisor.flight.record import Channel
from advisor.flight.renewal import renewed
from advisor.gravity import GRAVITY_M_S2
from advisor.oem.airspeed import airspeed
from advisor.oem.estimate import NoEstimate
from advisor.oem.lost_input import restored
from advisor.oem.problem import Problem, Record, Signal
from advisor.oem.surface import Servo

FEWEST_SAMPLES = 20
SPEED_CHANGE = 0.03
"""Beyond this relative change of air speed the derivatives are scaled with it ..."""
SMOOTH_SPEED_CHANGE = 0.01
"""... and already beyond this one when its shape comes from the accelerometers: no noise can pass for it."""


@dataclass(frozen=True, slots=True)
class Prepared:
    """The problem, and what was learnt on the way to it."""

    problem: Problem
    renewed_hz: float
    """Rate at which angle of attack really changes, the slowest of the manoeuvres."""
    alpha_held: bool
    """Angle of attack arrives under fresh stamps without being renewed."""
    missing: tuple[str, ...]
    """Outputs that no manoeuvre has: a_z, theta."""
    airspeed_lag_s: float
    """How late the air speed reads, mean over the manoeuvres."""
    airspeed_m_s: float | None
    """Mean measured speed."""


def prepare(
    maneuvers: Sequence[Maneuver], aircraft: Aircraft, outputs: Sequence[str] = ("alpha", "q", "a_z", "theta")
) -> Prepared | NoEstimate:
    """Collect what the estimator needs, or say why it cannot begin.

    Parameters
    ----------
    outputs : the outputs to use when measured; alpha and q always are.
    """
    for maneuver in maneuvers:
        missing = _missing(maneuver)
        if missing is not None:
            return missing
    usable = [name for name in outputs if all(_has(m.channels, name) for m in maneuvers)]
    speeds = [airspeed(m.channels) for m in maneuvers]
    if any(speed is None for speed in speeds) and aircraft.airspeed_m_s is None:
        usable = [name for name in usable if name != "a_z"]
    measured = [speed for speed in speeds if speed is not None]
    together = len(measured) == len(maneuvers)
    signals = [
        speed.signal if speed is not None and together else _constant(maneuver, aircraft.airspeed_m_s)
        for maneuver, speed in zip(maneuvers, speeds, strict=True)
    ]
    alphas = [_renewed(_signal(m.channels["alpha"])) for m in maneuvers]
    records = tuple(
        _record(maneuver, signal, alpha, usable)
        for maneuver, signal, (alpha, _) in zip(maneuvers, signals, alphas, strict=True)
    )
    known = [signal for signal in signals if signal is not None]
    return Prepared(
        problem=restored(
            Problem(
                records=records,
                reference_airspeed_m_s=_reference(known, aircraft, all(v.smooth for v in measured))
                if together
                else None,
                servo=Servo(aircraft.elevator.lag_s or 0.0, aircraft.elevator.delay_s or 0.0),
                vane_arm_m=(aircraft.alpha.vane_arm_m or 0.0) if known else 0.0,
                accelerometer_arm_m=aircraft.accelerometer.arm_m or 0.0,
            )
        ),
        renewed_hz=min((len(alpha.t) - 1) / float(alpha.t[-1] - alpha.t[0]) for alpha, _ in alphas),
        alpha_held=any(held for _, held in alphas),
        missing=tuple(name for name in outputs if name not in usable),
        airspeed_lag_s=float(np.mean([speed.lag_s for speed in measured])) if measured else 0.0,
        airspeed_m_s=float(np.mean([signal.y.mean() for signal in known])) if known else None,
    )


def _renewed(signal: Signal) -> tuple[Signal, bool]:
    """Samples that bring a new value, and whether the channel is held between them.

    A staircase under fresh stamps would count each value several times, and late.
    """
    t, y = renewed(signal.t, signal.y, FEWEST_SAMPLES)
    return Signal(t, y), len(t) < len(signal.t)


def _has(channels: Mapping[str, Channel], name: str) -> bool:
    return name in channels and int(np.count_nonzero(np.isfinite(channels[name].y))) >= FEWEST_SAMPLES


def _missing(maneuver: Maneuver) -> NoEstimate | None:
    for name, spoken in (("elevator", "the elevator"), ("alpha", "angle of attack"), ("q", "pitch rate")):
        samples = len(maneuver.channels[name]) if name in maneuver.channels else 0
        if not _has(maneuver.channels, name):
            text = (
                f"Manoeuvre {maneuver.number} has {samples} samples of {spoken}; it takes {FEWEST_SAMPLES}."
            )
            return NoEstimate("too_few_samples", text)
    if float(np.ptp(maneuver.channels["elevator"].y)) == 0.0:
        return NoEstimate("no_input", f"The elevator did not move in manoeuvre {maneuver.number}.")
    return None


def _record(maneuver: Maneuver, speed: Signal | None, alpha: Signal, usable: Sequence[str]) -> Record:
    channels = maneuver.channels
    outputs = {"alpha": alpha, "q": _signal(channels["q"])}
    path = gravity = None
    if "a_z" in usable:
        outputs["a_z"] = _signal(channels["a_z"])
    if "theta" in usable:
        outputs["theta"] = _level(channels)
    if _has(channels, "theta"):
        theta = _signal(channels["theta"])
        cosine = np.cos(_signal(channels["bank"]).at(theta.t)) if _has(channels, "bank") else 1.0
        path = Signal(theta.t, theta.y - alpha.at(theta.t))
        gravity = Signal(theta.t, GRAVITY_M_S2 * np.cos(theta.y) * cosine)
    return Record(
        elevator=_signal(channels["elevator"]),
        outputs=outputs,
        airspeed=speed,
        path=path,
        gravity_z=gravity,
    )


def _level(channels: Mapping[str, Channel]) -> Signal:
    """Pitch angle as if the wings were level: θ minus the integral of (cos φ - 1)·q - r·sin φ."""
    theta = _signal(channels["theta"])
    if not _has(channels, "bank"):
        return theta
    bank = _signal(channels["bank"]).at(theta.t)
    rate = (np.cos(bank) - 1.0) * _signal(channels["q"]).at(theta.t)
    if _has(channels, "r"):
        rate = rate - np.sin(bank) * _signal(channels["r"]).at(theta.t)
    return Signal(theta.t, theta.y - integrated(theta.t, rate))


def _constant(maneuver: Maneuver, speed: float | None) -> Signal | None:
    if speed is None:
        return None
    return Signal(maneuver.channels["elevator"].t[[0, -1]], np.array([speed, speed]))


def _reference(speeds: Sequence[Signal], aircraft: Aircraft, smooth: bool) -> float | None:
    """Reference air speed, when the speed moves enough to matter."""
    together = np.concatenate([speed.y for speed in speeds])
    if np.min(together) <= 0.0:
        return None
    reference = aircraft.reference_airspeed_m_s or float(np.mean(together))
    enough = SMOOTH_SPEED_CHANGE if smooth else SPEED_CHANGE
    moved = float(np.max(together) - np.min(together)) > enough * reference
    apart = abs(float(np.mean(together)) / reference - 1.0) > enough / 2.0
    return reference if moved or apart else None


def _signal(channel: Channel) -> Signal:
    keep = np.isfinite(channel.y)
    return Signal(np.asarray(channel.t[keep], float), np.asarray(channel.y[keep], float))
