"""Information of a fit in roll and yaw, and its gain on manoeuvres that it has not seen.

Residuals are coloured, so a nat of white noise counts as ``share``² nats.
"""

from typing import NamedTuple, Self

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.axes.lateral.fit import Fit, Known
from advisor.oem.covariance import Coloured, coloured, colours_of, cramer_rao, influence, widening
from advisor.oem.evaluation import contributions_of
from advisor.oem.scatter_between import widened_by_scatter


class Information(NamedTuple):
    """Information of each manoeuvre about derivatives and numbers."""

    matrix: FloatArray
    """(m, k, k)"""
    gradient: FloatArray
    """(m, k) at the optimum."""


def information_of(fit: Fit, share: float) -> Information:
    """Return the information of each manoeuvre, with coloured residuals counted as ``share``² of white
    ones."""
    weighed = share * fit.columns * fit.weight[:, None]
    left = share * fit.residual * fit.weight
    parts = [fit.assembly.owner == m for m in range(fit.assembly.maneuvers)]
    return Information(
        np.array([weighed[rows].T @ weighed[rows] for rows in parts]),
        np.array([weighed[rows].T @ left[rows] for rows in parts]),
    )


def share_of(fit: Fit) -> float:
    """Return the error of the derivatives by white noise over their error by the residuals: coloured within a
    manoeuvre, and scattered between manoeuvres."""
    told = influence(fit.assembly, fit.sensitivities, fit.noise)
    if told is None:
        return 1.0
    colours = colours_of(fit.assembly, fit.residual, fit.sensitivities)
    noise = Coloured(colours, widening(fit.assembly, told.rows, colours))
    bound = np.diag(cramer_rao(fit.assembly, told.rows, fit.noise))
    pulls = contributions_of(fit.assembly, told.rows, fit.residual)
    found = np.diag(widened_by_scatter(coloured(fit.assembly, told.rows, noise), pulls))
    ratio = np.sqrt(bound[found > 0.0] / found[found > 0.0])
    return float(np.clip(np.median(ratio), 0.0, 1.0)) if len(ratio) else 1.0


def posterior_of(fit: Fit, told: Information, known: Known) -> tuple[FloatArray, FloatArray]:
    """Return mean (15 + k,) and covariance of derivatives and numbers under a prior."""
    posterior = np.sum(told.matrix, axis=0) + np.diag(known.precision)
    pull = np.sum(told.gradient, axis=0) - known.precision * (fit.values - known.mean)
    covariance = np.linalg.inv(posterior)
    return fit.values + covariance @ pull, covariance


class Squares(NamedTuple):
    """Sums of squares (m, outputs) that a model leaves under a prior."""

    in_fit: FloatArray
    held_out: FloatArray
    """Prediction of each manoeuvre from all other manoeuvres. Derivatives and numbers come from these and
    from the prior. Trims, initial states and biases come from the manoeuvre itself."""


def squares_of(fit: Fit, told: Information, known: Known) -> Squares:
    """Return the squares of a model in the fit, and on manoeuvres held out one by one."""
    matrix, gradient = np.sum(told.matrix, axis=0), np.sum(told.gradient, axis=0)
    squares = np.zeros((2, fit.assembly.maneuvers, len(fit.noise)))
    for m, without in np.ndindex(fit.assembly.maneuvers, 2):
        posterior = matrix - without * told.matrix[m] + np.diag(known.precision)
        pull = gradient - without * told.gradient[m] - known.precision * (fit.values - known.mean)
        rows = fit.assembly.owner == m
        left = fit.residual[rows] - fit.columns[rows] @ np.linalg.solve(posterior, pull)
        squares[without, m] = np.bincount(fit.assembly.channel[rows], left**2, len(fit.noise))
    return Squares(*squares)


class Gain(NamedTuple):
    """Log likelihood that one model gains over another, nats."""

    total: float
    std: float
    """Standard error of the total, by the scatter of the manoeuvres."""

    @classmethod
    def between(cls, before: FloatArray, after: FloatArray, counts: FloatArray, share: float) -> Self:
        """Return the gain from the first to the second sum of squares, (m, outputs) each, of ``counts``
        (outputs,) samples."""
        told = counts > 0.0
        sums = before[:, told].sum(axis=0), after[:, told].sum(axis=0)
        total = 0.5 * share**2 * float(np.sum(counts[told] * np.log(sums[0] / sums[1])))
        each = 0.5 * share**2 * np.sum((before - after)[:, told] * counts[told] / sums[1], axis=1)
        return cls(total, float(np.sqrt(len(each)) * np.std(each, ddof=1)) if len(each) > 1 else np.inf)
