"""Foresight of effects that are judged outside the fits: moving air, air speed, and the offset of α.

Moving air is found if a filter with moving air explains the data far better than one with still air. The
expected gain in log likelihood follows from the eigenvalues of the responses. For a disturbance of size s
with independent unit coefficients and gains λ,

    E{gain} = ½ Σ (λ + s²λ² + a²g²) s_f²/(1 + s_f²λ) − ½ Σ ln(1 + s_f²λ),

where s_f is the size that the filter assumes, and a²g² the part of a gust of given course.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from advisor.gap.candidates.alpha_offset import least_offset_rad
from advisor.gap.candidates.distinguish import need_of, way_to_distinguish
from advisor.gap.decision import CERTAIN
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.linear import pulse_response
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.foresight.foresee import Foreseen, Signature
from advisor.gap.foresight.signatures import Signatures
from advisor.gap.noise.probes import disturbance_columns
from advisor.gap.records.flights import PreparedManeuver, PreparedManeuvers
from advisor.gap.search.air import AIR_MANEUVERS, LEAST_GUST_ANGLE
from advisor.gap.simulator.layout import DISTURB_AIR, REFERENCE, SPEED
from advisor.oem.prepare import SPEED_CHANGE
from advisor.process.arrays import FloatArray

CLIMB_RATE_STD_M_S = 0.1
"""Prior: noise of an unmeasured climb rate, m/s, with one independent reading per second."""
_ANGLES = np.geomspace(1e-5, 0.5, 200)
"""Numerical: candidate gust angles, rad, one for each filter."""
_SPEED_STEP = 0.01
"""Numerical: relative step of the speed for the signature of the air speed."""


@dataclass(frozen=True)
class _Air:
    """Responses to moving air along their principal axes, over the manoeuvres searched for moving air."""

    gains: FloatArray
    """Eigenvalue λ of every axis, in units of the noise's variance per rad²."""
    gust: FloatArray
    """Coordinate g of the response to a gust of 1 rad along each principal axis."""
    inside: float
    """Cosine between the gust's response and the nearest response to turbulence."""

    def expected(self, spread: float, peak: float) -> float:
        """Return the expected log likelihood gain for turbulence and a gust, rad, with the best filter."""
        power = self.gains + (spread * self.gains) ** 2 + (peak * self.gust) ** 2
        assumed = (_ANGLES**2)[:, None]
        taken = assumed / (1.0 + assumed * self.gains) * power - np.log1p(assumed * self.gains)
        return float(np.max(0.5 * np.sum(taken, axis=1)))


def foresee_air(
    problem: EffectProblem, fitted: EffectFit, signatures: Signatures, unit_s: float
) -> list[Foreseen]:
    """Return the smallest detectable turbulence and (1 − cos) gust, which lasts two time units of the
    input."""
    if "alpha" not in problem.channels:
        return [impossible(effect, problem.flights) for effect in ("turbulence", "gust")]
    air = _air(problem, fitted, signatures, 2.0 * unit_s)
    speed = problem.flights.reference_m_s
    spread = _first(lambda angle: air.expected(angle, 0.0))
    peak = _first(lambda angle: air.expected(0.0, angle))
    way = way_to_distinguish("turbulence", "gust")
    return [
        Foreseen("turbulence", "sigma_w_m_s", speed * spread, (), ""),
        Foreseen("gust", "amplitude_m_s", speed * peak, (("turbulence", air.inside),), way),
    ]


def speed_signature(problem: EffectProblem, fitted: EffectFit, signatures: Signatures) -> Signature:
    """Return the signature of the speed effect for alternately fast and slow manoeuvres, at a constant-speed
    simulator."""
    p = problem.driving(fitted.point)
    columns = []
    for i, flight in enumerate(problem.flights.flights):
        moved = _at_speed(flight, 1.0 + (_SPEED_STEP if i % 2 else -_SPEED_STEP))
        constant = moved.at_constant_speed()
        real, simulated = (problem.read(f, problem.fly(f, p[i]), p[i]) for f in (moved, constant))
        columns.append((real - simulated) / _SPEED_STEP)
    return Signature("airspeed_variation", "change", signatures.of(columns), SPEED_CHANGE)


def foresee_offset(problem: EffectProblem, noise: FloatArray) -> Foreseen:
    """Return the detectability of a constant α offset from θ minus climb angle, without derivatives."""
    flights = problem.flights
    if not {"alpha", "theta"} <= set(flights.channels) or not {"climb_rate", "airspeed"} <= flights.has:
        return impossible("alpha_bias", flights)
    angles = [noise[flights.channels.index(c)] for c in ("alpha", "theta")]
    reading = float(np.hypot(np.hypot(*angles), CLIMB_RATE_STD_M_S / flights.reference_m_s))
    std = reading / np.sqrt(sum(f.duration_s for f in flights.flights))
    way = "set the attitude's zero on the ground and fly in still air, because both causes look alike"
    return Foreseen("alpha_bias", "bias_rad", least_offset_rad(std), (), way)


def impossible(effect: str, flights: PreparedManeuvers) -> Foreseen:
    """Return an effect that the plan cannot show at any size, with the channel or manoeuvre to add."""
    need = need_of(effect, flights)
    return Foreseen(effect, need.parameter, float("inf"), (), need.add)


def _air(problem: EffectProblem, fitted: EffectFit, signatures: Signatures, length_s: float) -> _Air:
    """Return the responses to moving air, with a gust after the last step of the first manoeuvre."""
    p = problem.driving(fitted.point)
    gains, gusts = [], []
    for i, flight in enumerate(problem.flights.flights[:AIR_MANEUVERS]):
        B = signatures.within(i, disturbance_columns(problem, flight, p[i], "air"))
        value, vector = np.linalg.eigh(B.T @ B)
        gains.append(np.maximum(value, 0.0))
        x = signatures.within(i, _gust(problem, flight, p[i], length_s)[:, None])[:, 0] if i == 0 else None
        gusts.append(np.zeros(len(value)) if x is None else vector.T @ (B.T @ x))
        if x is not None:
            seen = value > 1e-9 * value[-1]
            inside = float(np.sqrt(np.sum(gusts[0][seen] ** 2 / value[seen]) / (x @ x)))
    return _Air(np.concatenate(gains), np.concatenate(gusts), min(inside, 1.0))


def _gust(problem: EffectProblem, flight: PreparedManeuver, p: FloatArray, length_s: float) -> FloatArray:
    """Return the response of all channels, shape (rows,), to a (1 − cos) gust of 1 rad at its peak."""
    n = max(round(length_s / flight.h), 2)
    shape = 0.5 * (1.0 - np.cos(2.0 * np.pi * (np.arange(n) + 0.5) / n))
    pulse = pulse_response(problem, flight, p, DISTURB_AIR)
    response = np.vstack([np.convolve(row, shape)[: flight.n + 1] * flight.h for row in pulse])
    return problem.read_delayed(flight, response, np.array([flight.last_step_s]), p)[:, 0]


def _at_speed(flight: PreparedManeuver, factor: float) -> PreparedManeuver:
    slow = flight.slow.copy()
    slow[SPEED] = flight.trim[REFERENCE] * factor
    return replace(flight, slow=slow)


def _first(gain: Callable[[float], float]) -> float:
    """Return the smallest gust angle with enough expected gain."""
    angles = [a for a in _ANGLES if a >= LEAST_GUST_ANGLE]
    return next((float(a) for a in angles if gain(a) >= CERTAIN), float("inf"))
