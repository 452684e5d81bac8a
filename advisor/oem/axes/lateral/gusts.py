"""Side gusts in the residuals of roll and yaw, and what they add to the errors of an estimate.

A gust adds its angle to the sideslip that fin, wing and vane meet. Side force, roll and yaw thus change
together, and the Dutch roll answers. The gust's angle is linear between knots, with an exponential
correlation, as in Dryden's turbulence across the flight path. Noise of an instrument, however coloured,
enters its own output alone. The likelihoods of the residuals distinguish both.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import minimize
from scipy.special import expit

from advisor.flight.signals.messages import FloatArray
from advisor.model.axes.lateral import LATERAL
from advisor.model.response import Index
from advisor.oem.axes.lateral.disturbance import Course, Linear, courses_of
from advisor.oem.covariance import cramer_rao
from advisor.oem.extra import Extra
from advisor.oem.model_error import directions
from advisor.oem.solution import Solution
from advisor.oem.turbulence import KNOTS_S
from advisor.oem.weighing import Weighing

MEMORY_S = 1.0
"""Prior: correlation time of the gust angle, s. One test is too short to determine it: with the time free,
gusts on a jet become a drift of 60 s."""
_RANGE, _MOST_STEPS = (1e-3, 1e3), 400
"""Numerical: range of every standard deviation relative to its start, and most steps of the search."""


class Sums(NamedTuple):
    """Inner products of one manoeuvre, from which the likelihood under any gusts is computed.

    The k columns are the residual and the derivatives of the outputs by the parameters.
    """

    counts: FloatArray
    """Shape (outputs,): number of rows of each output."""
    squares: FloatArray
    """Shape (outputs, k, k): inner products of the columns."""
    pulls: FloatArray
    """Shape (outputs, knots, k): inner products of gust responses and columns."""
    grams: FloatArray
    """Shape (outputs, knots, knots): inner products of the gust responses."""

    @classmethod
    def of(cls, channel: Index, columns: FloatArray, course: Course) -> "Sums":
        """Return the inner products of ``columns`` (n, k), whose rows belong to the outputs ``channel``
        (n,)."""
        each = (channel == c for c in range(len(LATERAL.outputs)))
        parts = [(columns[own], course.columns[own]) for own in each]
        return cls(
            np.array([float(len(left)) for left, _ in parts]),
            np.array([left.T @ left for left, _ in parts]),
            np.array([gust.T @ left for left, gust in parts]),
            np.array([gust.T @ gust for _, gust in parts]),
        )


class Air(NamedTuple):
    """White noise of the outputs and the gust angle's statistics."""

    noise: FloatArray
    """Shape (outputs,): standard deviation of each output's white noise."""
    angle: float
    """Standard deviation of the gust angle, rad."""

    def angles(self, knots: FloatArray) -> FloatArray:
        """Return the covariance (k, k) of the gust angle at ``knots`` (k,), rad²."""
        return np.asarray(self.angle**2 * np.exp(-np.abs(knots[:, None] - knots) / MEMORY_S))

    def weighed(self, sums: Sequence[Sums]) -> tuple[float, FloatArray]:
        """Return the log determinant of the residuals' covariance, and the products (k, k) weighted by its
        inverse, of all manoeuvres together."""
        parts = [self._weighed(one) for one in sums]
        return sum(volume for volume, _ in parts), np.sum([inner for _, inner in parts], axis=0)

    def _weighed(self, sums: Sums) -> tuple[float, FloatArray]:
        """Return log determinant and products of one manoeuvre.

        The gust angle is a first-order Markov process, so the inverse of its covariance at the knots has
        three diagonals.
        """
        weight, n = self.noise**-2.0, sums.grams.shape[1]
        memory = np.exp(-KNOTS_S / MEMORY_S)
        fresh = self.angle**2 * -np.expm1(-2.0 * KNOTS_S / MEMORY_S)  # variance that a step adds
        whole, k = np.tensordot(weight, sums.grams, 1), np.arange(n)
        whole[k, k] += (1.0 + memory**2 * ((k > 0) & (k < n - 1))) / fresh
        whole[k[1:], k[:-1]] -= memory / fresh
        whole[k[:-1], k[1:]] -= memory / fresh
        lower = np.linalg.cholesky(whole)
        explained = solve_triangular(lower, np.tensordot(weight, sums.pulls, 1), lower=True)
        volume = float(sums.counts @ np.log(self.noise**2)) + 2.0 * float(np.sum(np.log(np.diag(lower))))
        volume += 2.0 * np.log(self.angle) + (n - 1) * np.log(fresh)
        return volume, np.tensordot(weight, sums.squares, 1) - explained.T @ explained


def likeliest(
    sums: Sequence[Sums],
    noise: FloatArray,
    cost: Callable[[float, FloatArray], float],
    near: Air | None = None,
) -> Air:
    """Return the white noise and gusts of least cost.

    Parameters
    ----------
    noise
        Shape (outputs,): standard deviation of each output's residual.
    cost
        -2 log likelihood, as a function of what ``Air.weighed`` returns.
    near
        Gusts of a similar fit, at which the search begins.
    """
    there = np.flatnonzero(sum(one.counts for one in sums))
    own = noise[there]
    powers = [own**-2.0 @ np.trace(one.grams[there], axis1=1, axis2=2) / np.sum(one.counts) for one in sums]
    sizes = np.append(own, 1.0 / max(float(np.mean(np.sqrt(powers))), 1e-12))

    def air(x: FloatArray) -> Air:
        white = np.ones(len(noise))
        white[there] = np.exp(x[:-1])
        return Air(white, float(np.exp(x[-1])))

    first = sizes if near is None else np.append(near.noise[there], near.angle)
    low, high = (np.log(share * sizes) for share in _RANGE)
    begun: FloatArray = np.clip(np.log(first), low, high)

    def at(x: FloatArray) -> float:
        return cost(*air(x).weighed(sums))

    found = minimize(
        at, begun, method="Nelder-Mead",
        bounds=np.column_stack([low, high]).tolist(),
        options={"maxfev": _MOST_STEPS, "xatol": 0.02, "fatol": 0.1},
    )  # fmt: skip
    return air(found.x)


def in_moving_air(solution: Solution) -> Solution:
    """Return a solution whose errors contain side gusts, as far as gusts explain the residuals better.

    The covariance in gusts is AᵀΓA, with the influence A of the measurements. Gusts and coloured instruments
    count by their restricted likelihoods. The colour of an output's noise leaves out what the output's own
    best fit explains. The likelihood of coloured instruments is therefore that at its best common variance.
    """
    laid, noise, rows = solution.assembly, solution.optimum.noise, solution.influence.rows
    fit = Linear(solution.problem, laid, solution.theta, solution.sensitivities, noise)
    extra = solution.extra or Extra.none(len(laid.z))
    free = np.column_stack([solution.sensitivities[:, laid.common], extra.columns])
    free = np.concatenate([fit.unabsorbed(m, free[block]) for m, block in enumerate(laid.blocks)])
    free = directions(free * fit.weight[:, None]) / fit.weight[:, None]
    columns = np.column_stack([solution.residual, free])
    courses = list(zip(laid.blocks, courses_of(fit), strict=True))
    sums = [Sums.of(laid.channel[block], columns[block], course) for block, course in courses]
    air = likeliest(sums, noise, _restricted)
    weighing = Weighing.by(solution.noise.colours, laid)
    white = weighing.forward(columns)
    left, volume = _left(white.T @ white)
    freedom = max(len(white) - free.shape[1] - len(laid.own) * laid.maneuvers, 1)
    still = weighing.volume + volume + freedom * (1.0 + np.log(max(left, 1e-300) / freedom))
    share = float(expit(0.5 * (still - _restricted(*air.weighed(sums)))))
    blown = solution.covariance_cr + cramer_rao(laid, rows, air.noise) - cramer_rao(laid, rows, noise)
    for block, course in courses:
        pull = rows[block].T @ course.columns
        blown += pull @ air.angles(course.knots) @ pull.T
    return replace(solution, covariance=share * blown + (1.0 - share) * solution.covariance)


def _restricted(volume: float, inner: FloatArray) -> float:
    """Return -2 log restricted likelihood of residuals, from what ``Air.weighed`` returns."""
    return volume + sum(_left(inner))


def _left(inner: FloatArray) -> tuple[float, float]:
    """Return the squares that the parameters leave and the log determinant of their information.

    ``inner`` (1 + k, 1 + k) holds weighted products of the residual and of the parameters' derivatives.
    """
    taken = inner[0, 1:] @ np.linalg.solve(inner[1:, 1:], inner[1:, 0])
    return float(inner[0, 0] - taken), float(np.linalg.slogdet(inner[1:, 1:])[1])
