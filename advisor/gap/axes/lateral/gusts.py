"""Side gusts in the residuals of a fit, distinguished from coloured noise of the instruments.

A gust adds its angle to the sideslip that fin, wing and vane meet, so it enters side force, roll and yaw
together. The gust's angle is linear between knots, with an exponential correlation, as in Dryden's
turbulence across the flight path. Noise of an instrument, however coloured, enters its own output alone. The
likelihoods of the residuals distinguish gusts from instrument noise.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular
from scipy.optimize import minimize

from advisor.flight.signals.messages import FloatArray
from advisor.gap.axes.lateral.disturbance import Course
from advisor.gap.axes.lateral.fit import Fit, Known
from advisor.gap.inference.marginal import marginal
from advisor.gap.noise.probes import KNOTS_S
from advisor.model.axes.lateral import LATERAL
from advisor.oem.arrow import solved_within
from advisor.oem.colour import Stretch, find_colour
from advisor.oem.whitening import schedule, whiten

_MEMORY_S = 1.0
"""Correlation time of the gusts at which the search begins, s."""
_RANGE = (1e-3, 1e3)
"""Range of every standard deviation in the search, relative to its start."""
_LONGEST_MEMORY_S = 60.0
_MOST_STEPS = 400
_BEND = 0.2
"""Finite-difference step of the gust angle's logarithm, for the curvature of the likelihood."""


@dataclass(frozen=True, slots=True)
class Gusts:
    """White noise of the outputs and the gust angle's statistics, as estimated from the residuals."""

    noise: FloatArray
    """Shape (outputs,): standard deviation of each output's white noise."""
    angle: float
    """Standard deviation of the gust angle, rad."""
    memory_s: float
    """Correlation time of the gust angle, s."""
    angle_std: float
    """Standard error of the gust angle's standard deviation, rad, with all other parameters fixed."""
    likelihood: float
    """Log likelihood of the residuals, on the scale of ``Fit.likelihood``."""
    matrix: FloatArray
    """Shape (k, k): information about derivatives and effect parameters under gust-coloured residuals."""
    gradient: FloatArray
    """Shape (k,): gradient of the log likelihood at the fit."""

    def change(self, known: Known, fit: Fit) -> FloatArray:
        """Return the change (k,) from the fit to the optimum with gusts and prior, within the bounds."""
        low, high = fit.bounds
        pull = self.gradient + known.precision * (known.mean - fit.values)
        whole = self.matrix + np.diag(known.precision)
        return solved_within(whole, pull, low - fit.values, high - fit.values)

    def height(self, known: Known, fit: Fit) -> float:
        """Return the log posterior density of the fit with these gusts, up to a constant."""
        return self.likelihood - 0.5 * float(known.precision @ (fit.values - known.mean) ** 2)

    def at(self, fit: Fit, courses: Sequence[Course]) -> "Gusts":
        """Return gusts of the same statistics, with the likelihood and its slopes at another fit."""
        sums = [_Sums.of(fit, m, course) for m, course in enumerate(courses)]
        volume, inner = _weighed(sums, self.noise, self.angle, self.memory_s)
        likelihood = -0.5 * (volume + float(inner[0, 0]) - len(fit.fitted))
        return replace(self, likelihood=likelihood, matrix=inner[1:, 1:], gradient=inner[1:, 0])


def side_gusts(fit: Fit, courses: Sequence[Course], known: Known, near: Gusts | None = None) -> Gusts:
    """Return the likeliest white noise and gusts in the residuals of a fit.

    Derivatives and effect parameters are integrated out, because a white-noise fit has absorbed part of the
    gusts.

    Parameters
    ----------
    known
        Prior of derivatives and effect parameters.
    near
        Gusts of a similar fit, at which the search begins.
    """
    prior = known.prior(fit.values)
    sums = [_Sums.of(fit, m, course) for m, course in enumerate(courses)]
    there = np.unique(fit.assembly.channel)
    reach = np.mean(
        [
            np.sqrt(np.mean((course.columns * fit.weight[fit.assembly.owner == m, None]) ** 2))
            for m, course in enumerate(courses)
        ]
    ) * np.sqrt(len(courses[0].knots))
    angle = 1.0 / max(float(reach), 1e-12)

    def model(x: FloatArray) -> tuple[FloatArray, float, float]:
        noise = np.ones(len(fit.noise))
        noise[there] = np.exp(x[:-2])
        return noise, float(np.exp(x[-2])), float(np.exp(x[-1]))

    def cost(x: FloatArray) -> float:
        volume, inner = _weighed(sums, *model(x))
        likelihood = -0.5 * (volume + float(inner[0, 0]))
        return -2.0 * marginal(likelihood, inner[1:, 1:], inner[1:, 0], prior, prior).right

    sizes = np.append(fit.noise[there], angle)
    first = [*sizes, _MEMORY_S] if near is None else [*near.noise[there], near.angle, near.memory_s]
    bounds = [*((np.log(_RANGE[0] * s), np.log(_RANGE[1] * s)) for s in sizes),
              (np.log(KNOTS_S), np.log(_LONGEST_MEMORY_S))]  # fmt: skip
    begun = np.log([np.clip(x, *np.exp(ends)) for x, ends in zip(first, bounds, strict=True)])
    found = minimize(
        cost, begun, method="Nelder-Mead", bounds=bounds,
        options={"maxfev": _MOST_STEPS, "xatol": 0.02, "fatol": 0.1},
    )  # fmt: skip
    step = _BEND * (np.arange(len(found.x)) == len(found.x) - 2)
    bend = (cost(found.x + step) - 2.0 * float(found.fun) + cost(found.x - step)) / (2.0 * _BEND**2)
    noise, angle, memory_s = model(found.x)
    empty = np.empty((len(fit.values), len(fit.values)))
    gusts = Gusts(noise, angle, memory_s, angle / np.sqrt(max(bend, _BEND)), np.nan, empty, empty[0])
    return gusts.at(fit, courses)


def coloured_likelihood(fit: Fit) -> float:
    """Return the residuals' log likelihood with coloured noise in each instrument, on the scale of
    ``Fit.likelihood``."""
    cost = 0.0
    for name in LATERAL.outputs:
        parts = [fit.residual[named[name]] for named in fit.assembly.rows if name in named]
        if not parts:
            continue
        colour = find_colour([Stretch(left, np.ones((len(left), 1))) for left in parts])
        variance = max(colour.variance, float(np.finfo(float).tiny))
        for left in parts:
            # White noise is a first-order autoregression without memory.
            scale, gain, determinant = schedule(len(left), colour.memory, colour.white_share)
            white = whiten(np.ascontiguousarray(left[:, None]), colour.memory, scale, gain)[0]
            cost += len(left) * (np.log(variance) - 1.0) + determinant + float(white @ white) / variance
    return -0.5 * cost


def _weighed(
    sums: Sequence["_Sums"], noise: FloatArray, angle: float, memory_s: float
) -> tuple[float, FloatArray]:
    """Return the log determinant of the residuals' covariance, and the products (k, k) weighted by its
    inverse, of all manoeuvres together."""
    parts = [one.weighed(noise, angle, memory_s) for one in sums]
    return sum(volume for volume, _ in parts), np.sum([inner for _, inner in parts], axis=0)


class _Sums(NamedTuple):
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
    def of(cls, fit: Fit, m: int, course: Course) -> "_Sums":
        """Return the inner products of manoeuvre ``m``."""
        rows = fit.assembly.owner == m
        channel = fit.assembly.channel[rows]
        columns = np.column_stack([fit.residual[rows], fit.columns[rows]])
        parts = [(columns[channel == c], course.columns[channel == c]) for c in range(len(fit.noise))]
        return cls(
            np.array([float(len(left)) for left, _ in parts]),
            np.array([left.T @ left for left, _ in parts]),
            np.array([gust.T @ left for left, gust in parts]),
            np.array([gust.T @ gust for _, gust in parts]),
        )

    def weighed(self, noise: FloatArray, angle: float, memory_s: float) -> tuple[float, FloatArray]:
        """Return the log determinant of the residuals' covariance, and the products (k, k) weighted by its
        inverse.

        White noise has standard deviations (outputs,). The gust angle is a first-order Markov process, so the
        inverse of its covariance at the knots has three diagonals.
        """
        weight, n = noise**-2.0, self.grams.shape[1]
        memory = np.exp(-KNOTS_S / memory_s)
        fresh = angle**2 * -np.expm1(-2.0 * KNOTS_S / memory_s)  # variance that a step adds
        whole, k = np.tensordot(weight, self.grams, 1), np.arange(n)
        whole[k, k] += (1.0 + memory**2 * ((k > 0) & (k < n - 1))) / fresh
        whole[k[1:], k[:-1]] -= memory / fresh
        whole[k[:-1], k[1:]] -= memory / fresh
        lower = np.linalg.cholesky(whole)
        explained = solve_triangular(lower, np.tensordot(weight, self.pulls, 1), lower=True)
        volume = float(self.counts @ np.log(noise**2)) + 2.0 * float(np.sum(np.log(np.diag(lower))))
        volume += 2.0 * np.log(angle) + (n - 1) * np.log(fresh)
        return volume, np.tensordot(weight, self.squares, 1) - explained.T @ explained
