"""Posterior along one parameter for which the interval by linearisation does not describe the posterior.

A covariance at an optimum describes the nearest hill of the posterior. A servo's lag that the data hardly
determine has a long, flat ridge, along which the derivatives bend. The parameter is held at several values,
and all others are searched again. MINOS (James & Roos, *Computer Physics Communications* 10, 1975) and the
profile likelihood (Venzon & Moolgavkar, *Applied Statistics* 37, 1988) do the same. The second moment of
these optima replaces the linear part of the covariance that the parameter causes. The resulting interval
about the best optimum contains the interval of the profile.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from advisor.oem.extra import penalty
from advisor.oem.solution import Solution
from advisor.process.arrays import FloatArray
from advisor.words.quantiles import NORMAL_95

FARTHEST_NATS = 4.0
"""Numerical: fall of the log posterior density at which the walk along the parameter ends. A Gaussian holds
0.5 % of its probability beyond it."""
MOST_STEPS = 6
"""Numerical: most steps of one standard deviation to each side."""
ALIKE_NATS = 0.5 * NORMAL_95**2
"""Fall of the log posterior density up to which two optima explain the record alike. The value is the 95 %
limit of a likelihood ratio with one degree of freedom, 1.9."""

Refit = Callable[[Any, Solution], Solution | None]
"""Function that searches all parameters but the profiled one again; None if the search fails.

Its arguments are the problem with the new value, and the nearest solution."""


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """Optima of all other parameters at several values of one parameter."""

    place: int
    """Index of the profiled parameter among the nuisance parameters."""
    values: FloatArray
    """Shape (n,): values of the parameter in its unit, rising."""
    nats: FloatArray
    """Shape (n,): fall of the log posterior density from the best optimum."""
    theta: FloatArray
    """Shape (n, p + k): parameters and nuisance parameters at each value."""
    best: FloatArray
    """Shape (p + k,): parameters and nuisance parameters at the best optimum."""

    @property
    def weights(self) -> FloatArray:
        """Shape (n,): posterior probability of each value, by the trapezoidal rule."""
        density = np.exp(-self.nats)
        width = np.zeros(len(self.values))
        steps = np.diff(self.values)
        width[:-1] += steps
        width[1:] += steps
        mass = density * width
        return np.asarray(mass / np.sum(mass))

    @property
    def moment(self) -> FloatArray:
        """Shape (p + k, p + k): second moment of the optima about the best one.

        An interval of each parameter holds every optimum that explains the record alike.
        """
        apart = self.theta - self.best
        moment = (self.weights[:, None] * apart).T @ apart
        std = np.sqrt(np.diag(moment))
        reach = np.max(np.abs(self.alike[:, 1:] - self.best), axis=0) / NORMAL_95
        factor = np.maximum(np.divide(reach, std, out=np.ones_like(std), where=std > 0.0), 1.0)
        return np.asarray(moment * np.outer(factor, factor))

    @property
    def alike(self) -> FloatArray:
        """Shape (m, 1 + p + k): optima that explain the record alike, with the ends of the 95 % interval.

        Each row has the value of the profiled parameter, then all parameters.
        """
        rows = np.column_stack([self.values, self.theta])
        found = [row for row, nats in zip(rows, self.nats, strict=True) if nats <= ALIKE_NATS]
        depth, limit = np.sqrt(self.nats), np.sqrt(ALIKE_NATS)  # of a parabola, linear in the parameter
        for k in np.flatnonzero(np.diff(self.nats <= ALIKE_NATS)):
            share = (limit - depth[k]) / (depth[k + 1] - depth[k])
            found.append(rows[k] + share * (rows[k + 1] - rows[k]))
        return np.array(found)


def needs_profile(value: float, std: float) -> bool:
    """Return whether the linear interval of a positive parameter reaches zero, so that the posterior is not
    Gaussian within it.
    """
    return NORMAL_95 * std >= value


def profiled(solution: Solution, x: Any, parameters: Sequence[Any], share: float, refit: Refit) -> Solution:
    """Return the solution with the second moment of the posterior along one parameter.

    Parameters
    ----------
    x
        Profiled parameter, one of ``parameters``.
    parameters
        Nuisance parameters, whose derivatives are the solution's first extra columns.
    share
        Ratio of the parameters' errors under white noise to those under coloured noise.
    """
    place = len(solution.theta) + list(parameters).index(x)
    std = float(np.sqrt(solution.widened[place, place]))
    if not std > 0.0:
        return solution
    nodes = sorted(_walk(solution, x, parameters, share, refit, std), key=lambda node: node[0])
    if len(nodes) < 2:
        return solution  # no neighbouring value has an optimum
    values, nats, theta = (np.array(part) for part in zip(*nodes, strict=True))
    profile = Profile(
        place - len(solution.theta),
        values,
        nats - min(float(np.min(nats)), 0.0),
        theta,
        _at(solution, parameters),
    )
    column = solution.widened[:, place]
    linear = np.outer(column, column) / column[place]
    size = len(profile.best)
    linear = linear[:size, :size]
    scale = np.sqrt(np.diag(profile.moment) + np.diag(linear))
    return replace(solution, modes=_positive(profile.moment - linear, scale), profile=profile)


def _walk(
    solution: Solution, x: Any, parameters: Sequence[Any], share: float, refit: Refit, std: float
) -> Iterator[tuple[float, float, FloatArray]]:
    """Yield value, fall of the log posterior density and parameters, outwards from the optimum."""
    others = [p for p in parameters if p is not x]
    begun = _density(solution, parameters, parameters, share)
    here = x.read(solution.problem)
    yield here, 0.0, _at(solution, parameters)
    for way in (1.0, -1.0):
        near = solution
        for k in range(1, MOST_STEPS + 1):
            value = float(np.clip(here + way * k * std, x.lowest, x.highest))
            found = refit(x.write(near.problem, value), near)
            if found is None:
                break
            near = found
            fall = _density(found, others, parameters, share) - begun
            yield value, fall, _at(found, parameters)
            if fall > FARTHEST_NATS or value in (x.lowest, x.highest):
                break


def _density(solution: Solution, searched: Sequence[Any], parameters: Sequence[Any], share: float) -> float:
    """Return -log posterior density, up to a constant, with the residuals' colour in ``share``.

    The cost of the fit holds the narrowed priors of the ``searched`` parameters.
    """
    data = solution.optimum.log_likelihood_cost - penalty(solution.problem, searched)
    true = [replace(p, prior=replace(p.prior, share=1.0)) for p in parameters if p.prior is not None]
    return 0.5 * (share**2 * data + penalty(solution.problem, true))


def _at(solution: Solution, parameters: Sequence[Any]) -> FloatArray:
    return np.array([*solution.theta, *(p.read(solution.problem) for p in parameters)])


def _positive(matrix: FloatArray, scale: FloatArray) -> FloatArray:
    """Return the part of a symmetric matrix with positive eigenvalues, in the units of ``scale`` (n,)."""
    scale = np.where(scale > 0.0, scale, 1.0)
    powers, vectors = np.linalg.eigh(matrix / np.outer(scale, scale))
    return np.asarray((vectors * np.maximum(powers, 0.0)) @ vectors.T * np.outer(scale, scale))
