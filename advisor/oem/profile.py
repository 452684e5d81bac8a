"""Posterior over several optima, and along a parameter for which it is not Gaussian.

A covariance at an optimum describes the nearest hill of the posterior. A servo delays the response as a pole
of the aircraft does. If both are exchanged, the rate after an input is unchanged, and the posterior has two
hills. The less likely hill adds its second moment times its probability.

A lag that the data hardly determine has a long, flat ridge, along which the derivatives bend. The parameter
is held at several values, and all others are searched again. MINOS (James & Roos, *Computer Physics
Communications* 10, 1975) and the profile likelihood (Venzon & Moolgavkar, *Applied Statistics* 37, 1988) do
the same. The second moment of these optima replaces the linear part of the covariance that the parameter
causes. The resulting interval about the best optimum contains the interval of the profile.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.special import expit

from advisor.oem.extra import penalty
from advisor.oem.solution import Solution, reported
from advisor.process.arrays import FloatArray
from advisor.words.quantities import NORMAL_95

FARTHEST_NATS = 4.0
"""Numerical: fall of the log posterior density at which the walk along the parameter ends. A Gaussian holds
0.5 % of its probability beyond it."""
MOST_STEPS = 6
"""Numerical: most steps of one standard deviation to each side."""
ALIKE_NATS = 0.5 * NORMAL_95**2
"""Fall of the log posterior density up to which two optima explain the record alike. The value is the 95 %
limit of a likelihood ratio with one degree of freedom, 1.9."""

Refit = Callable[[Sequence[Any], Any, Any], Any]
"""Function that searches all parameters but the profiled one again; None if the search fails.

Its arguments are these parameters, the problem with the new value, and the nearest fit."""


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """Optima of all other parameters at several values of one parameter."""

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
        density = np.exp(-np.minimum(self.nats, 10.0 * FARTHEST_NATS))  # no weight rounds to zero
        mass = density * np.convolve(np.diff(self.values), [1.0, 1.0])
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
        ends = [row for row, nats in zip(rows, self.nats, strict=True) if nats <= ALIKE_NATS]
        depth, limit = np.sqrt(self.nats), np.sqrt(ALIKE_NATS)  # of a parabola, linear in the parameter
        for k in np.flatnonzero(np.diff(self.nats <= ALIKE_NATS)):
            share = (limit - depth[k]) / (depth[k + 1] - depth[k])
            ends.append(rows[k] + share * (rows[k + 1] - rows[k]))
        return np.array(ends)


class Posterior(NamedTuple):
    """Knowledge with which optima are weighed."""

    parameters: Sequence[Any]
    """Nuisance parameters, whose derivatives are a solution's first extra columns."""
    share: float
    """Ratio of the parameters' errors under white noise to those under coloured noise."""
    usual: Callable[[Any, FloatArray], float] = lambda *_: 0.0
    """Function that returns -2 log density of knowledge that the search does not use, for a problem and the
    reported parameters (p,)."""

    def apart(self, best: Any, rival: Any) -> tuple[float, FloatArray]:
        """Return how many nats a rival optimum lies below another one, and the moment of the less likely one.

        The moment, shape (p + k, p + k), is the second moment of the distance times the probability of the
        less likely optimum. ``best`` and ``rival`` are fits or solutions.
        """
        theta, other = theta_of(best), theta_of(rival)
        lower = self.share**2 * (rival.optimum.log_likelihood_cost - best.optimum.log_likelihood_cost)
        nats = 0.5 * (lower + self.usual(rival.problem, other) - self.usual(best.problem, theta))
        moved = [x.read(rival.problem) - x.read(best.problem) for x in self.parameters]
        step = np.array([*(other - theta), *moved])
        return nats, float(expit(-abs(nats))) * np.outer(step, step)

    def density(self, solution: Any, searched: Sequence[Any]) -> float:
        """Return -log posterior density, up to a constant, with the residuals' colour in ``share``.

        The cost of the fit holds the narrowed priors of the ``searched`` parameters.
        """
        data = solution.optimum.log_likelihood_cost - penalty(solution.problem, searched)
        true = [replace(p, prior=replace(p.prior, share=1.0)) for p in self.parameters if p.prior is not None]
        nats = penalty(solution.problem, true) + self.usual(solution.problem, theta_of(solution))
        return 0.5 * float(self.share**2 * data + nats)

    def at(self, solution: Any) -> FloatArray:
        """Return parameters and nuisance parameters of a fit or solution, shape (p + k,)."""
        return np.array([*theta_of(solution), *(p.read(solution.problem) for p in self.parameters)])

    def row(self, solution: Any, x: Any) -> FloatArray:
        """Return the value of the parameter ``x``, then all parameters, shape (1 + p + k,)."""
        return np.array([x.read(solution.problem), *self.at(solution)])


def theta_of(at: Any) -> FloatArray:
    """Return the reported parameters (p,) of a fit or of a solution."""
    return reported(at.optimum.shared, at.optimum.local, at.assembly.names)


def profiled(solution: Solution, x: Any, posterior: Posterior, refit: Refit) -> Solution:
    """Return the solution with the second moment of the posterior along a positive parameter ``x``.

    ``x`` is one of the posterior's parameters. The posterior is Gaussian where the linear interval of ``x``
    does not reach zero. The moment of another optimum remains.
    """
    place = len(solution.theta) + list(posterior.parameters).index(x)
    column = replace(solution, modes=None).widened[:, place]
    std = float(np.sqrt(column[place]))
    here = x.read(solution.problem)
    if not std > 0.0 or NORMAL_95 * std < here:
        return solution
    around = list(_walk(solution, x, posterior, refit, std))
    if not around:
        return solution  # no neighbouring value has an optimum
    nodes = sorted([(here, 0.0, posterior.at(solution)), *around], key=lambda node: node[0])
    values, nats, theta = (np.array(part) for part in zip(*nodes, strict=True))
    nats -= min(float(np.min(nats)), 0.0)
    profile = Profile(values, nats, theta, posterior.at(solution))
    size = len(profile.best)
    linear = (np.outer(column, column) / column[place])[:size, :size]
    scale = np.sqrt(np.diag(profile.moment) + np.diag(linear))
    bent = _positive(profile.moment - linear, scale)
    hills = profile.alike[:0] if solution.alike is None else solution.alike[1:]
    alike = np.vstack([posterior.row(solution, x), *hills, *profile.alike])
    return replace(solution, modes=bent if solution.modes is None else solution.modes + bent, alike=alike)


def _walk(
    solution: Solution, x: Any, posterior: Posterior, refit: Refit, std: float
) -> Iterator[tuple[float, float, FloatArray]]:
    """Yield value, fall of the log posterior density and parameters, outwards from the optimum."""
    others = [p for p in posterior.parameters if p is not x]
    begun = posterior.density(solution, posterior.parameters)
    for way in (1.0, -1.0):
        near, fall = solution, 0.0
        for _ in range(MOST_STEPS):
            there = x.moved(near.problem, way * std)
            ends = fall > FARTHEST_NATS or x.read(there) == x.read(near.problem)
            refitted = None if ends else refit(others, there, near)
            if refitted is None:
                break
            near, fall = refitted, posterior.density(refitted, others) - begun
            yield x.read(there), fall, posterior.at(refitted)


def _positive(matrix: FloatArray, scale: FloatArray) -> FloatArray:
    """Return the part of a symmetric matrix with positive eigenvalues, in the units of ``scale`` (n,)."""
    unit = np.where(scale > 0.0, scale, 1.0)
    powers, vectors = np.linalg.eigh(matrix / np.outer(unit, unit))
    return np.asarray((vectors * np.maximum(powers, 0.0)) @ vectors.T * np.outer(scale, scale))
