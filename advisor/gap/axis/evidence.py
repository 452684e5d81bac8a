"""Information of a fit about its parameters, and its log likelihood gain on held-out manoeuvres.

Residuals are coloured, so one nat of the white-noise likelihood counts as ``share``² nats.
"""

from typing import NamedTuple

import numpy as np
from scipy.special import erfcx

from advisor.gap.axis.fit import Fit, Known
from advisor.gap.result import Value
from advisor.oem.arrow import solved_within
from advisor.oem.evaluation import errors_of, share_of
from advisor.oem.extra import Extra
from advisor.oem.scatter_between import widened_by_scatter
from advisor.process.arrays import FloatArray


class Information(NamedTuple):
    """Information of each manoeuvre about derivatives and effect parameters."""

    matrix: FloatArray
    """Shape (m, k, k): information matrix of each manoeuvre."""
    gradient: FloatArray
    """Shape (m, k): gradient of each manoeuvre's log likelihood at the optimum."""


def information_of(fit: Fit, share: float) -> Information:
    """Return the information of each manoeuvre; coloured residuals scale it by ``share``²."""
    weighed = share * fit.columns * fit.weight[:, None]
    left = share * fit.residual * fit.weight
    parts = [fit.assembly.owner == m for m in range(fit.assembly.maneuvers)]
    return Information(
        np.array([weighed[rows].T @ weighed[rows] for rows in parts]),
        np.array([weighed[rows].T @ left[rows] for rows in parts]),
    )


def colour_share(fit: Fit, lacking: bool = False) -> float:
    """Return the ratio of the derivatives' standard error under white noise to that from the residuals.

    Parameters
    ----------
    lacking
        Whether the error contains the dynamics that the model lacks, as that of an estimate.
    """
    no_prior = np.zeros(len(fit.point.theta))
    about = fit.assembly, fit.residual, fit.sensitivities, fit.noise
    errors = errors_of(*about, None, no_prior, fitted=fit.fitted if lacking else None)
    if errors is None:
        return 1.0
    scattered = widened_by_scatter(errors["covariance"], errors["contributions"])
    return share_of(errors["covariance_cr"], scattered + errors["systematic"])


def posterior_at(fit: Fit, prior: Known, share: float) -> tuple[FloatArray, FloatArray]:
    """Return the mean (s + k,) and the standard errors of derivatives and effect parameters.

    Like the errors of an estimate, these errors contain the scatter between the manoeuvres and the dynamics
    that the model lacks.
    """
    mean = fit.values + step_of(fit, information_of(fit, share), prior)
    n = len(fit.point.theta)
    weight, off = prior.precision[n:] ** 0.5, (prior.mean - fit.values)[n:]
    extra = Extra(fit.slopes, weight, weight * off, np.full(len(weight), share))
    precision, about = prior.precision[:n] / share**2, (fit.residual, fit.sensitivities, fit.noise)
    errors = errors_of(fit.assembly, *about, extra, precision, fitted=fit.fitted, prior_share=share)
    if errors is None:
        return mean, prior.precision**-0.5
    scattered = widened_by_scatter(errors["covariance"], errors["contributions"])
    return mean, np.diag(scattered + errors["systematic"]) ** 0.5


def within_bounds(fit: Fit, information: Information, prior: Known) -> tuple[Information, float]:
    """Return the information with each parameter that ends at a bound integrated out, and the nats of that.

    Such a parameter has an exponential density inside its bound, and the others move as it stays there.
    """
    matrix, gradient = (np.sum(part, axis=0) for part in information)
    low, high = (bound - fit.values for bound in fit.bounds)
    whole = matrix + np.diag(prior.precision)
    pull = gradient + prior.precision * (prior.mean - fit.values)
    step = solved_within(whole, pull, low, high)
    held = (step <= low) | (step >= high)
    moved = np.where(held, step, 0.0)
    precision, bend = prior.precision[held], np.diag(whole)[held]
    slope = np.abs(pull - whole @ step)[held]
    nats = moved @ (gradient - 0.5 * matrix @ moved)
    nats -= 0.5 * precision @ (fit.values + moved - prior.mean)[held] ** 2
    nats += np.sum(np.log(0.5 * (precision / bend) ** 0.5 * erfcx(slope / (2.0 * bend) ** 0.5)))
    free = ~held
    change = information.gradient - information.matrix @ moved
    return Information(information.matrix * np.outer(free, free), change * free), float(nats)


def step_of(fit: Fit, information: Information, prior: Known) -> FloatArray:
    """Return the step (s + k,) from the fit to the posterior mean."""
    pull = np.sum(information.gradient, axis=0) - prior.precision * (fit.values - prior.mean)
    return np.linalg.solve(np.sum(information.matrix, axis=0) + np.diag(prior.precision), pull)


class Squares(NamedTuple):
    """Sums of squared residuals (m, outputs) of a model under a prior."""

    in_fit: FloatArray
    held_out: FloatArray
    """Sums of squares of each manoeuvre's error when it is predicted from all others. Derivatives and effect
    parameters come from all other manoeuvres and from the prior. Trims, initial states and biases come from
    the predicted manoeuvre itself."""


def squares_of(fit: Fit, information: Information, prior: Known) -> Squares:
    """Return the sums of squares of a model in the fit, and on manoeuvres held out one by one."""
    matrix, gradient = np.sum(information.matrix, axis=0), np.sum(information.gradient, axis=0)
    squares = np.zeros((2, fit.assembly.maneuvers, len(fit.noise)))
    for m, without in np.ndindex(fit.assembly.maneuvers, 2):
        posterior = matrix - without * information.matrix[m] + np.diag(prior.precision)
        pull = gradient - without * information.gradient[m] - prior.precision * (fit.values - prior.mean)
        rows = fit.assembly.owner == m
        # A parameter that stays at its bound has no information.
        step = np.linalg.solve(posterior, pull) * np.any(matrix != 0.0, axis=0)
        left = fit.residual[rows] - fit.columns[rows] @ step
        squares[without, m] = np.bincount(fit.assembly.channel[rows], left**2, len(fit.noise))
    return Squares(*squares)


def gained(before: FloatArray, after: FloatArray, counts: FloatArray, share: float) -> Value:
    """Return the gain in log likelihood of a second model over a first model, nats, with its standard error.

    The error follows from the scatter between manoeuvres.

    Parameters
    ----------
    before, after
        Shape (m, outputs): sums of squared errors of both models.
    """
    seen = counts > 0.0
    sums = before[:, seen].sum(axis=0), after[:, seen].sum(axis=0)
    total = 0.5 * share**2 * float(np.sum(counts[seen] * np.log(sums[0] / sums[1])))
    each = 0.5 * share**2 * np.sum((before - after)[:, seen] * counts[seen] / sums[1], axis=1)
    return Value(total, float(np.sqrt(len(each)) * np.std(each, ddof=1)) if len(each) > 1 else np.inf)
