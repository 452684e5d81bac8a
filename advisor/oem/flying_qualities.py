"""Flying qualities of the short period from an estimate, with 95 % intervals by the delta method.

A and B are the matrices of Eqs. (1)-(3), V is the true air speed, and the elevator is held after a step:

    ω_n = √det A        ζ = -tr A/(2·ω_n)        1/T_θ2 = (M_α·Z_δe - M_δe·Z_α)/M_δe
    n/α = V/g·(M_δe·Z_α - M_α·Z_δe)/(M_q·Z_δe - (1 + Z_q)·M_δe)        CAP = ω_n²/(n/α)

T_θ2 is the zero of pitch rate to elevator, and n/α the ratio of the steady load factor to the steady angle of
attack. The static margin is -C_mα/C_Lα = M_α·I_yy/(Z_α·m·V·c), with drag's part in lift direction neglected.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft.reference import PARAMETERS, Reference
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.instruments.atmosphere import AirData
from advisor.model.mil_f_8785c import CATEGORIES, LIMITS, LevelFound, assess
from advisor.oem.estimate import Estimate
from advisor.words.quantities import NORMAL_95, symbol

UNITS: Mapping[str, str] = {
    "natural_frequency": "rad/s",
    "damping": "1",
    "t_theta_2": "s",
    "n_alpha": "g/rad",
    "cap": "rad²/s² per g/rad",
    "static_margin": "% chord",
    "neutral_point": "% chord",
}
_OF_THE_CHART = ("natural_frequency", "n_alpha")
"""The two axes of Figures 1 to 3 of MIL-F-8785C."""
_STEP = 1e-30
"""Imaginary step of the complex-step derivative. The complex-step derivative has no cancellation, so any step
without underflow is exact."""

_Function = Callable[[NDArray[np.complex128]], np.complex128]


@dataclass(frozen=True, slots=True)
class Quality:
    """One parameter of the flying qualities, in the unit of ``UNITS``."""

    value: float
    std: float

    @property
    def ci95(self) -> tuple[float, float]:
        """Lower and upper end of the 95 % interval."""
        return self.value - NORMAL_95 * self.std, self.value + NORMAL_95 * self.std


@dataclass(frozen=True, slots=True)
class FlyingQualities:
    """Flying qualities of an estimate."""

    qualities: Mapping[str, Quality]
    """Qualities by the names of ``UNITS``, as far as estimate and reference data allow."""
    levels: tuple[LevelFound, ...]
    """Levels of MIL-F-8785C by category; empty if a required parameter is missing."""
    air: AirData
    airspeed_m_s: float | None
    """Air speed of the derivatives as the aircraft reads it, m/s."""
    true_airspeed_m_s: float | None
    """True air speed in n/α, CAP and the coefficients, m/s."""
    left_out: Mapping[str, str] = field(default_factory=dict)
    """Reason for each missing parameter of ``UNITS``, by its name."""
    correlation: float | None = None
    """Correlation of the errors of natural frequency and n/α; None if either is missing."""


def flying_qualities(estimate: Estimate, air: AirData, reference: Reference) -> FlyingQualities:
    """Return the flying qualities of an estimate.

    Parameters
    ----------
    estimate
        Derivatives with the covariance that is corrected for coloured residuals.
    air
        Atmosphere, which converts the logged air speed to the true air speed.
    reference
        Mass, chord, pitching inertia and centre of gravity, for static margin and neutral point.
    """
    flown = estimate.airspeed_m_s
    read, speed = (None, None) if flown is None else (air.read_speed(flown), air.true_speed(flown))
    qualities: dict[str, Quality] = {}
    left_out: dict[str, str] = {}
    functions = _functions(speed, reference)
    for name, function in functions.items():
        quality = function if isinstance(function, str) else _with_error(function, estimate)
        if isinstance(quality, Quality):
            qualities[name] = quality
        else:
            left_out[name] = quality
    together = [functions[name] for name in _OF_THE_CHART if name in qualities]
    correlation = _correlation(together, estimate)
    return FlyingQualities(qualities, _levels(qualities), air, read, speed, left_out, correlation)


def _correlation(functions: Sequence[_Function | str], estimate: Estimate) -> float | None:
    """Return the correlation of the errors of two qualities; None if either is missing or has no error."""
    gradients = [_gradient(function, estimate) for function in functions if not isinstance(function, str)]
    if len(gradients) < len(_OF_THE_CHART):
        return None
    (a, between), (_, b) = np.array(gradients) @ estimate.covariance @ np.array(gradients).T
    return float(between / (a * b) ** 0.5) if a > 0.0 and b > 0.0 else None


def _levels(qualities: Mapping[str, Quality]) -> tuple[LevelFound, ...]:
    names = ("damping", "cap", "natural_frequency", "n_alpha")
    if any(name not in qualities for name in names):
        return ()
    measured = [(qualities[name].value, qualities[name].ci95) for name in names]
    return tuple(assess(category, LIMITS[category], measured) for category in CATEGORIES)


def _functions(speed: float | None, reference: Reference) -> dict[str, _Function | str]:
    """Return each quality as a function of the eight parameters, or the reason why it is missing."""
    without_speed = "no air speed is known"
    functions: dict[str, _Function | str] = {
        "natural_frequency": _frequency,
        "damping": lambda t: -(t[1] + t[6]) / (2.0 * _frequency(t)),
        "t_theta_2": lambda t: t[7] / (t[5] * t[3] - t[7] * t[1]),
        "n_alpha": without_speed,
        "cap": without_speed,
    }
    margin = _margin(speed, reference)
    if speed is not None:
        per_g = speed / GRAVITY_M_S2
        functions["n_alpha"] = lambda t: per_g * _turn_per_alpha(t)
        functions["cap"] = lambda t: _stiffness(t) / (per_g * _turn_per_alpha(t))
    functions["static_margin"] = functions["neutral_point"] = margin
    cg = reference.cg_percent_chord
    if not isinstance(margin, str):
        functions["neutral_point"] = (
            "reference.cg_percent_chord is not given" if cg is None else lambda t: cg + margin(t)
        )
    return functions


def _margin(speed: float | None, reference: Reference) -> _Function | str:
    """Return the static margin as a function, in percent of the chord."""
    mass, chord, inertia = reference.mass_kg, reference.chord_m, reference.iyy_kg_m2
    needed = {"mass_kg": mass, "chord_m": chord, "iyy_kg_m2": inertia}
    missing = [f"reference.{name}" for name, value in needed.items() if value is None]
    if mass is None or chord is None or inertia is None:
        return f"{', '.join(missing)} {'is' if len(missing) == 1 else 'are'} not given"
    if speed is None:
        return "no air speed is known"
    factor = 100.0 * inertia / (mass * speed * chord)
    return lambda t: factor * t[5] / t[1]


def _stiffness(t: NDArray[np.complex128]) -> np.complex128:
    return np.complex128(t[1] * t[6] - (1.0 + t[2]) * t[5])


def _frequency(t: NDArray[np.complex128]) -> np.complex128:
    """Return the natural frequency ω_n; NaN for a statically unstable aircraft."""
    stiffness = _stiffness(t)
    return np.complex128(np.sqrt(stiffness) if stiffness.real > 0.0 else np.nan)


def _turn_per_alpha(t: NDArray[np.complex128]) -> np.complex128:
    """Return the steady pitch rate over the steady angle of attack with the elevator held, 1/s."""
    return np.complex128((t[7] * t[1] - t[5] * t[3]) / (t[6] * t[3] - (1.0 + t[2]) * t[7]))


def _with_error(function: _Function, estimate: Estimate) -> Quality | str:
    """Return the value and standard deviation by the delta method, or the reason why both are missing."""
    gradient = _gradient(function, estimate)
    with np.errstate(divide="ignore", invalid="ignore"):
        value = float(function(estimate.theta.astype(np.complex128)).real)
    unknown = [
        n for n, g in zip(PARAMETERS, gradient, strict=True) if g != 0.0 and n in estimate.not_identifiable
    ]
    if unknown:
        return f"{', '.join(map(symbol, unknown))} cannot be determined from these manoeuvres"
    variance = float(gradient @ estimate.covariance @ gradient)
    if not (isfinite(value) and isfinite(variance)):
        return "the short period is statically unstable (det A ≤ 0)"
    return Quality(value, variance**0.5)


def _gradient(function: _Function, estimate: Estimate) -> NDArray[np.float64]:
    """Return the derivatives of a quality with respect to the eight parameters, shape (8,)."""
    theta = estimate.theta.astype(np.complex128)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.array([function(theta + 1j * _STEP * unit).imag / _STEP for unit in np.eye(len(theta))])
