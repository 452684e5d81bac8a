"""The missing law of an answer without a name, as a curve over the quantity on which it depends most.

The likeliest course of a force or a moment that the plain model lacks is regressed on pitch rate, angle of
attack, elevator and time. Its linear part is that of the derivatives, which the fit has taken.
"""

from collections.abc import Callable, Mapping

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.inference.residual import innovation_noise
from advisor.gap.noise.probes import disturbance_courses, probe_blocks
from advisor.gap.result import MissingLaw, Value
from advisor.oem.turbulence import KNOTS_S
from advisor.process.arrays import FloatArray
from advisor.words.quantiles import NORMAL_95

_EQUATIONS = {"force_equation": "Z", "moment_equation": "M"}
"""Letter of the equation in which each block's law acts, by the block's name."""
_FORMS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "{0}*abs({0})": lambda x: x * np.abs(x),
    "{0}**2": np.square,
    "{0}**3": lambda x: x**3,
}
"""Numerical: formulas that are compared, by their text with the name of the quantity."""
_PARTS = 8
"""Numerical: number of equally filled parts of the curve."""


def missing_law(problem: EffectProblem, fitted: EffectFit, block: str) -> MissingLaw | None:
    """Return the law that acts in a block beyond a fit; None for a block that is no equation."""
    if block not in _EQUATIONS:
        return None
    assert problem.instruments is not None
    probe = next(p for p in probe_blocks(problem, fitted, innovation_noise(problem)) if p.block == block)
    (course,) = disturbance_courses(problem, fitted, problem.instruments, block, [probe.size])
    lacking = np.concatenate(course.knots)
    shares = {
        name: _share(x, lacking, [x, x * np.abs(x), x**2, x**3]) for name, x in _quantities(problem).items()
    }
    variable = max(shares, key=lambda name: shares[name])
    x = _quantities(problem)[variable]
    nearest, runner_up = _by_nearness(x, lacking)[:2]
    value = _coefficient(x, lacking, _FORMS[nearest](x))
    named = ("", "") if variable == "t" else (nearest.format(variable), runner_up.format(variable))
    curve = tuple(_curve(x, lacking))
    return MissingLaw(_EQUATIONS[block], variable, shares[variable], curve, value, *named)


def _quantities(problem: EffectProblem) -> Mapping[str, FloatArray]:
    """Return pitch rate, angle of attack, elevator and time at the knots of all manoeuvres, from trim."""
    found: dict[str, list[FloatArray]] = {}
    for flight in problem.flights.flights:
        t = np.arange(0.0, flight.duration_s, KNOTS_S)[1:]
        found.setdefault("q", []).append(flight.outputs["q"].at(t))
        found.setdefault("delta_e", []).append(np.interp(t, flight.t_u, flight.u) - flight.u_trim)
        found.setdefault("t", []).append(t + flight.started_s)
        if "alpha" in problem.channels:
            found.setdefault("alpha", []).append(flight.outputs["alpha"].at(t) - flight.alpha_trim)
    joined = {name: np.concatenate(parts) for name, parts in found.items()}
    joined["t"] = joined["t"] - float(joined["t"][0])
    return joined


def _share(x: FloatArray, lacking: FloatArray, columns: list[FloatArray]) -> float:
    """Return the share of the course's variance that columns and a constant explain."""
    system = np.column_stack([np.ones(len(x)), *columns])
    system = system / np.maximum(np.linalg.norm(system, axis=0), 1e-300)
    left = lacking - system @ np.linalg.lstsq(system, lacking, rcond=None)[0]
    return float(1.0 - np.var(left) / max(np.var(lacking), 1e-300))


def _by_nearness(x: FloatArray, lacking: FloatArray) -> list[str]:
    """Return the formulas, the one nearest to the course next to a line first."""
    return sorted(_FORMS, key=lambda one: -_share(x, lacking, [x, _FORMS[one](x)]))


def _coefficient(x: FloatArray, lacking: FloatArray, form: FloatArray) -> Value:
    """Return the coefficient of a formula next to a line."""
    system = np.column_stack([np.ones(len(x)), x, form])
    found = np.linalg.lstsq(system, lacking, rcond=None)[0]
    noise = float(np.var(lacking - system @ found))
    std = np.sqrt(noise * np.linalg.pinv(system.T @ system)[2, 2])
    return Value(float(found[2]), float(std))


def _curve(x: FloatArray, lacking: FloatArray) -> list[tuple[float, float, float]]:
    """Return the mean of the course in each part of a quantity's range, with half its 95 % interval."""
    curve = []
    for part in np.array_split(np.argsort(x), _PARTS):
        half = NORMAL_95 * float(np.std(lacking[part])) / np.sqrt(max(len(part), 1))
        curve.append((float(np.mean(x[part])), float(np.mean(lacking[part])), float(half)))
    return curve
