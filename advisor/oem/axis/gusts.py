"""Gusts in the residuals of an axis, and what they add to the errors of an estimate.

A gust adds its angle to the incidence that wing, fin and vane meet. Force and moments thus change together,
and the aircraft answers. The gust's angle is linear between knots, with an exponential
correlation, as in Dryden's turbulence across the flight path. Noise of an instrument, however coloured,
enters its own output alone. The likelihoods of the residuals distinguish both.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotri

from advisor.model.response import Index
from advisor.oem.axis.disturbance import Course
from advisor.oem.turbulence import KNOTS_S
from advisor.process.arrays import FloatArray

MEMORY_S = 0.5, 5.0
"""Prior: range of the gust angle's correlation time, s, uniform in its logarithm.

Dryden's lengths are 20 to 600 m near the ground, and aircraft pass them at 20 to 130 m/s. One test hardly
determines the time. Without this range, slow model errors in still air look like gusts with a correlation
time of 60 s.
"""
_RANGE, _MOST_STEPS = (1e-3, 1e3), 100
"""Numerical: range of every standard deviation relative to its start, and most steps of the search."""
_BEND = 0.2
"""Numerical: finite-difference step of the logarithms of gust angle and memory."""
_FLAT = 0.1
"""Numerical: largest slope of -2 log likelihood, per standard error of a parameter, at its optimum."""


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
    def of(cls, channel: Index, outputs: int, columns: FloatArray, course: Course) -> "Sums":
        """Return the inner products of ``columns`` (n, k), whose rows belong to the outputs ``channel``
        (n,)."""
        each = (channel == c for c in range(outputs))
        parts = [(columns[own], course.columns[own]) for own in each]
        return cls(
            np.array([float(len(left)) for left, _ in parts]),
            np.array([left.T @ left for left, _ in parts]),
            np.array([gust.T @ left for left, gust in parts]),
            np.array([gust.T @ gust for _, gust in parts]),
        )


class Integrated(NamedTuple):
    """Gaussian prior of the parameters over which a likelihood is integrated. The precision is zero for a
    restricted likelihood.
    """

    precision: FloatArray
    """Shape (k,): inverse prior variances."""
    pull: FloatArray
    """Shape (k,): prior means minus the values of a fit."""

    def left(self, inner: FloatArray) -> tuple[float, float, FloatArray]:
        """Return the sum of squares after a fit of the parameters, and the log determinant of their
        information.

        The third result contains the slopes (1 + k, 1 + k) of their sum with respect to ``inner``.
        ``inner`` (1 + k, 1 + k) holds weighted products of the residual and of the parameters' derivatives.
        """
        whole = inner[1:, 1:] + np.diag(self.precision)
        inverse = np.linalg.inv(whole)
        end = inner[1:, 0] + self.precision * self.pull
        step = np.append(-1.0, inverse @ end)
        slopes = np.outer(step, step)
        slopes[1:, 1:] += inverse
        return float(inner[0, 0] - end @ step[1:]), float(np.linalg.slogdet(whole)[1]), slopes


class _Weighed(NamedTuple):
    """Residuals of one manoeuvre under given gusts."""

    volume: float
    """Log determinant of the residuals' covariance."""
    inner: FloatArray
    """Shape (k, k): inner products of the columns, weighted by the inverse of the residuals' covariance."""
    spread: FloatArray
    """Shape (knots, knots): covariance of the gust angles after the residuals."""
    likeliest: FloatArray
    """Shape (knots, k): gust angles of least squares for each column."""
    stiff: FloatArray
    """Shape (knots, knots): inverse covariance of the gust angles before the residuals."""


class Air(NamedTuple):
    """White noise of the outputs and the gust angle's statistics."""

    noise: FloatArray
    """Shape (outputs,): standard deviation of each output's white noise."""
    angle: float
    """Standard deviation of the gust angle, rad."""
    memory_s: float = (MEMORY_S[0] * MEMORY_S[1]) ** 0.5
    """Correlation time of the gust angle, s."""

    def angles(self, knots: FloatArray) -> FloatArray:
        """Return the covariance (k, k) of the gust angle at ``knots`` (k,), rad²."""
        return np.asarray(self.angle**2 * np.exp(-np.abs(knots[:, None] - knots) / self.memory_s))

    def weighed(self, sums: Sequence[Sums]) -> tuple[float, FloatArray]:
        """Return the log determinant of the residuals' covariance, and the products (k, k) weighted by its
        inverse, of all manoeuvres together."""
        parts = [self._weighed(s) for s in sums]
        return sum(part.volume for part in parts), np.sum([part.inner for part in parts], axis=0)

    def cost(self, sums: Sequence[Sums], prior: Integrated) -> tuple[float, FloatArray]:
        """Return -2 log likelihood without the parameters, and its slopes (outputs + 2,).

        The slopes are those by the logarithms of noise, gust angle and memory.
        The derivative of a log determinant is the trace of the inverse times the change (Magnus & Neudecker,
        *Matrix Differential Calculus*, ch. 8).
        """
        parts, weight = [self._weighed(own) for own in sums], self.noise**-2.0
        left, volume, slopes = prior.left(np.sum([part.inner for part in parts], axis=0))
        by_noise, by_angle, by_memory = np.zeros(len(weight)), 0.0, 0.0
        for own, part in zip(sums, parts, strict=True):
            turned = part.likeliest @ slopes
            spread = part.spread + turned @ part.likeliest.T
            products = np.tensordot(own.squares, slopes, 2) - 2.0 * np.tensordot(own.pulls, turned, 2)
            by_noise += 2.0 * own.counts - 2.0 * weight * (products + np.tensordot(own.grams, spread, 2))
            by_angle += 2.0 * (len(spread) - float(np.sum(spread * part.stiff)))
            by_memory += self._by_memory(spread, part.stiff)
        total = left + volume + sum(part.volume for part in parts)
        return total, np.append(by_noise, (by_angle, by_memory))

    def angle_std(self, sums: Sequence[Sums], prior: Integrated) -> float:
        """Return the standard error of the gust angle, rad, with the gusts' memory free."""
        sizes = np.exp([-_BEND, _BEND])
        near = [self._replace(angle=self.angle * by) for by in sizes]
        near += [self._replace(memory_s=self.memory_s * by) for by in sizes]
        smaller, larger, shorter, longer = (air.cost(sums, prior)[1][-2:] for air in near)
        (own, mixed), (_, memory) = np.array([larger - smaller, longer - shorter]) / (2.0 * _BEND)
        least = 24.0 / np.log(MEMORY_S[1] / MEMORY_S[0]) ** 2  # curvature of a uniform prior, by its variance
        bend = 0.5 * (own - mixed**2 / max(memory, least))
        return float(self.angle / np.sqrt(max(bend, _BEND)))

    def _by_memory(self, spread: FloatArray, stiff: FloatArray) -> float:
        """Return the slope of one manoeuvre's -2 log likelihood by the logarithm of the memory."""
        kept, n = np.exp(-KNOTS_S / self.memory_s), len(stiff)
        fresh = self.angle**2 * (1.0 - kept**2)
        change = 2.0 * kept * float(np.trace(spread[1:-1, 1:-1])) - 2.0 * float(np.trace(spread, 1))
        volume = float(np.sum(spread * stiff)) - (n - 1)
        by_kept = change / fresh + 2.0 * kept / (1.0 - kept**2) * volume
        return float(by_kept * kept * KNOTS_S / self.memory_s)

    def _weighed(self, sums: Sums) -> _Weighed:
        """Return the residuals of one manoeuvre under these gusts.

        The gust angle is a first-order Markov process, so the inverse of its covariance at the knots has
        three diagonals.
        """
        weight, n = self.noise**-2.0, sums.grams.shape[1]
        memory = np.exp(-KNOTS_S / self.memory_s)
        fresh = self.angle**2 * -np.expm1(-2.0 * KNOTS_S / self.memory_s)  # variance that a step adds
        stiff, k = np.zeros((n, n)), np.arange(n)
        stiff[k, k] = (1.0 + memory**2 * ((k > 0) & (k < n - 1))) / fresh
        stiff[k[1:], k[:-1]] = stiff[k[:-1], k[1:]] = -memory / fresh
        whole = stiff + np.tensordot(weight, sums.grams, 1)
        pulls = np.tensordot(weight, sums.pulls, 1)
        lower, _ = dpotrf(whole, lower=1)
        spread, _ = dpotri(lower, lower=1)
        spread = np.tril(spread) + np.tril(spread, -1).T
        likeliest = spread @ pulls
        volume = float(sums.counts @ np.log(self.noise**2)) + 2.0 * float(np.sum(np.log(np.diag(lower))))
        volume += 2.0 * np.log(self.angle) + (n - 1) * np.log(fresh)
        return _Weighed(
            volume, np.tensordot(weight, sums.squares, 1) - pulls.T @ likeliest, spread, likeliest, stiff
        )


def likeliest(sums: Sequence[Sums], noise: FloatArray, prior: Integrated, near: Air | None = None) -> Air:
    """Return the white noise and gusts of largest likelihood.

    Parameters
    ----------
    noise
        Shape (outputs,): standard deviation of each output's residual.
    prior
        Prior of the parameters, over which the likelihood is integrated.
    near
        Gusts of a similar fit, at which the search begins.
    """
    from scipy.optimize import minimize  # not on the start path

    counts = np.sum([s.counts for s in sums], axis=0)
    there = np.flatnonzero(counts)
    own = noise[there]
    powers = [own**-2.0 @ np.trace(s.grams[there], axis1=1, axis2=2) / np.sum(s.counts) for s in sums]
    size = 1.0 / max(float(np.mean(np.sqrt(powers))), 1e-12)
    # In this unit the curvature of -2 log likelihood is about 2.
    knots = sum(s.grams.shape[1] for s in sums)
    unit = np.append(2.0 * counts[there], (knots, knots)) ** -0.5

    def air(x: FloatArray) -> Air:
        white = np.zeros(len(noise))
        *white[there], angle, memory = x * unit
        return Air(np.exp(white), size * float(np.sinh(angle)), float(np.exp(memory)))

    def at(x: FloatArray) -> tuple[float, FloatArray]:
        value, slopes = air(x).cost(sums, prior)
        slopes[-2] /= np.tanh(x[-2] * unit[-2])
        return value, np.append(slopes[there], slopes[-2:]) * unit

    def place(noise: FloatArray, angle: float, memory_s: float) -> FloatArray:
        """Return the search's variables. For small gusts the likelihood is a parabola in the gust angle."""
        return np.append(np.log(noise), (np.arcsinh(angle / size), np.log(memory_s))) / unit

    low, high = (place(share * own, share * size, end) for share, end in zip(_RANGE, MEMORY_S, strict=True))
    first = Air(own, size) if near is None else near._replace(noise=near.noise[there])
    begun = place(*first)
    begun = np.clip(begun, low, high)
    optimum = minimize(
        at, begun, jac=True, method="L-BFGS-B",
        bounds=np.column_stack([low, high]).tolist(),
        options={"maxfun": _MOST_STEPS, "gtol": _FLAT, "ftol": 0.0},
    )  # fmt: skip
    return air(optimum.x)
