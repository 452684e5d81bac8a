"""The missing law of an answer without a name, as a curve over the quantity on which it depends most.

Every formula is flown through its equation, and competes by the residual of the outputs that it explains next
to all derivatives. The formula's linear part is that of the derivatives, which the fit has taken.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem, row_weights
from advisor.gap.fitting.step import factor
from advisor.gap.noise.quiet import responses_at_knots
from advisor.gap.result import MissingLaw, Value
from advisor.oem.arrow import solved
from advisor.oem.turbulence import KNOTS_S
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

_EQUATIONS = {
    "force_equation": "Z", "moment_equation": "M",
    "side_force": "Y", "rolling_moment": "L", "yawing_moment": "N",
}  # fmt: skip
"""Letter of the equation in which each block's law acts, by the block's name."""
_FORMS: Mapping[str, Callable[[FloatArray], FloatArray]] = {
    "{0}*abs({0})": lambda x: x * np.abs(x),
    "{0}**2": np.square,
    "{0}**3": lambda x: x**3,
}
"""Numerical: formulas that are compared, by their text with the name of the quantity."""
_RANK = 1e-6
"""Numerical: least size of a direction that columns span, relative to the largest."""
_POINTS = 9
"""Numerical: number of points of the curve."""


class Lacking(NamedTuple):
    """Weighted residual of one manoeuvre, and the response of its outputs to a law in one equation.

    What the manoeuvre's own trims and initial states absorb is removed.
    """

    quantities: Mapping[str, FloatArray]
    """Quantities on which a law may depend, from trim, at k knots: shape (k,), by name."""
    responses: FloatArray
    """Shape (n, k): response per unit of the law at each knot."""
    shared: FloatArray
    """Shape (n, s): sensitivities to the derivatives and effect parameters."""
    residual: FloatArray
    """Shape (n,)."""


def law_in(block: str, lacking: Iterable[Lacking], heat: float) -> MissingLaw | None:
    """Return the law that acts in a block beyond a fit; None for a block that is no equation.

    Parameters
    ----------
    heat
        Number of white-noise nats that count as one nat (``evidence.temperature``).
    """
    if block not in _EQUATIONS:
        return None
    maneuvers = list(lacking)
    shared, residual = (np.concatenate(x) for x in zip(*(m[2:] for m in maneuvers), strict=True))
    basis = _basis(shared)
    left = residual - basis @ (basis.T @ residual)
    fits: dict[str, _Fit] = {}
    for name in maneuvers[0].quantities:
        columns = np.concatenate([m.responses @ _forms(m.quantities[name]) for m in maneuvers])
        fits[name] = _Fit(columns - basis @ (basis.T @ columns), left)
    every = range(len(_FORMS))
    variable, fit = max(fits.items(), key=lambda named: named[1].explained(every))
    nearest, runner_up = sorted(every, key=lambda k: -fit.explained([k]))[:2]
    texts = [text.format(variable) if variable != "t" else "" for text in _FORMS]
    value, covariance = fit.solution([nearest])
    return MissingLaw(
        _EQUATIONS[block], variable, fit.explained(every) / max(float(left @ left), 1e-300),
        tuple(_curve(np.concatenate([m.quantities[variable] for m in maneuvers]), fit, heat)),
        Value(float(value[0]), float(np.sqrt(heat * covariance[0, 0]))), texts[nearest], texts[runner_up],
    )  # fmt: skip


def lacking(problem: EffectProblem, fitted: EffectFit, block: str) -> Iterator[Lacking]:
    """Yield what each manoeuvre of pitch shows of a law in an equation, beyond a fit."""
    assert problem.instruments is not None
    p = problem.driving(fitted.point)
    for i, flight in enumerate(problem.flights.flights):
        weights, linear = row_weights(problem, i, 1.0 / problem.instruments)[:, None], fitted.linear[i]
        own, responses = linear.measured.own * weights, responses_at_knots(problem, flight, p[i], block)
        columns = np.column_stack([responses, linear.measured.shared, fitted.residuals[i]]) * weights
        columns -= own @ solved(factor(own, linear.prior), own.T @ columns)
        k = responses.shape[1]
        yield Lacking(_quantities(problem, i), columns[:, :k], columns[:, k:-1], columns[:, -1])


def _quantities(problem: EffectProblem, i: int) -> Mapping[str, FloatArray]:
    """Return pitch rate, angle of attack, elevator and time of flight at the knots of a manoeuvre."""
    flight, first = problem.flights.flights[i], problem.flights.flights[0]
    t = np.arange(0.0, flight.duration_s, KNOTS_S)[1:]
    moved = {
        "q": flight.outputs["q"].at(t),
        "delta_e": np.interp(t, flight.t_u, flight.u) - flight.u_trim,
        "t": t + flight.started_s - first.started_s,
    }
    alpha = (
        {"alpha": flight.outputs["alpha"].at(t) - flight.alpha_trim} if "alpha" in problem.channels else {}
    )
    return moved | alpha


class _Fit(NamedTuple):
    """Least squares of the residual (n,) by the outputs' responses to the formulas, (n, formulas)."""

    columns: FloatArray
    residual: FloatArray

    def solution(self, which: Sequence[int]) -> tuple[FloatArray, FloatArray]:
        """Return the coefficients (k,) of some formulas, and their covariance (k, k) under white noise."""
        columns = self.columns[:, which]
        covariance = np.linalg.pinv(columns.T @ columns, _RANK**2, hermitian=True)
        return covariance @ (columns.T @ self.residual), np.asarray(covariance)

    def explained(self, which: Sequence[int]) -> float:
        """Return the power of the residual that some formulas explain."""
        return float(self.solution(which)[0] @ (self.columns[:, which].T @ self.residual))


def _forms(x: FloatArray) -> FloatArray:
    """Return all formulas of a quantity (k,), shape (k, formulas)."""
    return np.column_stack([form(x) for form in _FORMS.values()])


def _basis(columns: FloatArray) -> FloatArray:
    """Return an orthonormal basis of columns (n, k)."""
    u, size, _ = np.linalg.svd(columns / np.maximum(np.linalg.norm(columns, axis=0), 1e-300), False)
    return np.asarray(u[:, size > _RANK * size[0]])


def _curve(x: FloatArray, fit: _Fit, heat: float) -> list[tuple[float, float, float]]:
    """Return the law next to a line over a quantity's range, with half its 95 % interval."""
    at = np.linspace(np.min(x), np.max(x), _POINTS)
    value, covariance = fit.solution(range(len(_FORMS)))
    forms = _forms(at)
    halves = NORMAL_95 * np.sqrt(heat * np.einsum("ki,ij,kj->k", forms, covariance, forms))
    return list(zip(at.tolist(), (forms @ value).tolist(), halves.tolist(), strict=True))
