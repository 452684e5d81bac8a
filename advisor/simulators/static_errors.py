"""Sentences about errors of the trim, of the air speed, and of derivatives that differ by one factor. No
motion shows these errors.

Z_α = -q̄·S·C_Lα/(m·V) and M_α = q̄·S·c·C_mα/I_yy: mass scales the Zs, inertia the Ms, and density both.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import degrees

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.diagnose import Examined
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.result import Diagnosis, TrimDifference
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.simulators.protocol import Replay

_TRIM_OFF = {"alpha": 0.0175, "elevator": 0.0175, "throttle": 0.1}
"""Least difference of two trims that is reported, by quantity. A vane or a surface aligned by hand is
accurate to 0.5 deg. Thrust at one throttle differs by a tenth between engines of a type."""
_TRIM_SIGMAS = 3.0
"""Least difference of two trims, in standard deviations of the mean, that is reported."""
_TRIMMED = {
    "alpha": ("angle of attack", "flaps, incidence, weight or air speed differ, or the vane has an offset"),
    "elevator": ("elevator", "centre of gravity, flaps or thrust line differ, or the calibration is off"),
    "throttle": ("throttle", "drag or engine differ"),
}
_READS_WRONG = 0.03
"""Least relative error of the air speed that the sentence states first. The prior of a static port's error
has a standard deviation of 0.02."""
_SIGMAS = 3.0
"""Least difference of a common factor from 1, in standard deviations, that is reported."""
_TOGETHER = 0.05
"""Least common relative difference of derivatives that is reported, and largest difference of equal
factors."""
_MOMENTS, _FORCES = ("M_alpha", "M_q", "M_delta_e"), ("Z_alpha",)


def with_static_errors(
    diagnosis: Diagnosis, examined: Examined, trims: Sequence[TrimDifference] = ()
) -> Diagnosis:
    """Return the diagnosis with a sentence that begins with the static errors and ends with the withdrawn
    corrections.

    Parameters
    ----------
    trims
        Trims of simulator and aircraft; empty for a simulator without trim.
    """
    errors = (*_of_the_trims(trims), *_of_the_speed(examined), *_of_numbers_together(diagnosis, examined))
    sentence = " ".join([*errors, diagnosis.sentence, *diagnosis.taken_back])
    return replace(diagnosis, trims=tuple(trims), static=errors, sentence=sentence)


def is_off(trim: TrimDifference) -> bool:
    """Return whether two trims differ by more than instrument errors and scatter."""
    by = abs(trim.simulator - trim.aircraft)
    return by > max(_TRIM_OFF[trim.quantity], _TRIM_SIGMAS * trim.std)


def _of_the_trims(trims: Sequence[TrimDifference]) -> Iterator[str]:
    for trim in filter(is_off, trims):
        name, because = _TRIMMED[trim.quantity]
        by = trim.simulator - trim.aircraft
        size = f"{100.0 * abs(by):.0f} %" if trim.quantity == "throttle" else f"{abs(degrees(by)):.1f} deg"
        more = "more" if by > 0.0 else "less"
        yield f"The simulator trims at {size} {more} {name} than the aircraft: {because}."


def _of_the_speed(examined: Examined) -> Iterator[str]:
    scale = examined.findings.airspeed_scale
    if scale is not None and abs(scale.scale) > _READS_WRONG:
        read = 100.0 * (1.0 / (1.0 + scale.scale) - 1.0)
        yield f"The air speed reads {abs(read):.0f} % {'low' if read < 0.0 else 'high'} by the motion."


def _of_numbers_together(diagnosis: Diagnosis, examined: Examined) -> Iterator[str]:
    """Yield a sentence about one physical quantity that explains a common factor of several derivatives."""
    prior = examined.findings.problem.prior_derivatives
    if prior is None or diagnosis.verdict != "parameters":
        return
    given = dict(zip(DERIVATIVES, prior, strict=True))
    moment, force = (_common(diagnosis, given, names) for names in (_MOMENTS, _FORCES))
    if moment is None or force is None:
        return
    (m, m_std), (z, z_std) = moment, force
    m_off, z_off = (abs(r - 1.0) > max(_SIGMAS * s, _TOGETHER) for r, s in (moment, force))
    if m_off and z_off and abs(m - z) < max(_SIGMAS * np.hypot(m_std, z_std), _TOGETHER):
        yield f"All numbers are {m:.2f} times the simulator's: the air is denser or thinner by that factor."
    elif m_off and abs(z - 1.0) < max(_SIGMAS * z_std, _TOGETHER):
        yield (
            f"M_alpha, M_q and M_delta_e are {m:.2f} times the simulator's and Z_alpha agrees: the pitching "
            f"inertia is {1.0 / m:.2f} times the simulator's."
        )
    elif z_off and abs(m - 1.0) < max(_SIGMAS * m_std, _TOGETHER):
        yield (
            f"Z_alpha is {z:.2f} times the simulator's and the Ms agree: the mass is {1.0 / z:.2f} times the "
            "simulator's, or the lift is larger by this factor."
        )


def _common(
    diagnosis: Diagnosis, given: dict[str, float], names: Sequence[str]
) -> tuple[float, float] | None:
    """Return the common factor of some derivatives on the simulator's, with its error; or None."""
    if any(given[name] == 0.0 for name in names):
        return None
    ratios = np.array([diagnosis.model[name].value / given[name] for name in names])
    # A damping hardly tells a factor of a few per cent; its own scatter says so.
    stds = np.array([diagnosis.model[name].std / abs(given[name]) for name in names])
    weights = 1.0 / np.maximum(stds, 1e-6) ** 2
    mean = float(weights @ ratios / np.sum(weights))
    apart = np.abs(ratios - mean) > np.maximum(_SIGMAS * stds, _TOGETHER * mean)
    return None if np.any(apart) else (mean, float(1.0 / np.sqrt(np.sum(weights))))


def trim_differences(
    flights: PreparedManeuvers, maneuvers: Sequence[Maneuver], replays: Sequence[Replay], aircraft: Aircraft
) -> tuple[TrimDifference, ...]:
    """Return the trims of simulator and aircraft, averaged over the manoeuvres.

    The elevator is included if calibrated, and a control if the simulator reports it.
    """
    by_number = {m.number: m for m in maneuvers}
    flown = [_of_the_flight(f, by_number[f.number], aircraft) for f in flights.flights]
    simulated = [{"alpha": float(replay.alpha[0]), **replay.trim} for replay in replays]
    differences = []
    for name in ("alpha", "elevator", "throttle"):
        pairs = [(s[name], f[name]) for s, f in zip(simulated, flown, strict=True) if name in s and name in f]
        if pairs:
            theirs, ours = np.array(pairs).T
            std = float(np.std(theirs - ours) / np.sqrt(len(pairs)))
            differences.append(TrimDifference(name, float(np.mean(theirs)), float(np.mean(ours)), std))
    return tuple(differences)


def _of_the_flight(flight: PreparedManeuver, maneuver: Maneuver, aircraft: Aircraft) -> Mapping[str, float]:
    trim = {"alpha": flight.alpha_trim} if "alpha" in flight.outputs else {}
    if aircraft.elevator.is_calibrated:
        trim["elevator"] = flight.u_trim
    throttle = maneuver.channels.get("throttle")
    if throttle is not None:
        before = throttle.y[throttle.t <= flight.started_s + flight.first_step_s]
        if len(before):
            trim["throttle"] = float(np.mean(before))
    return trim
