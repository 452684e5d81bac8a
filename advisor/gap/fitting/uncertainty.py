"""Uncertainty of the shared parameters, and the distance of the fit from the aircraft file."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, Distance, distance_of, log_prior, prior_precision
from advisor.gap.fitting.problem import EffectProblem, counts
from advisor.gap.records.floor import effective_sample_size
from advisor.oem.arrow import inverse_of


def effective_samples(problem: EffectProblem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Return the effective sample size of each channel over all manoeuvres, shape (channels,)."""
    total = np.zeros(len(problem.channels))
    for flight, residual in zip(problem.flights.flights, residuals, strict=True):
        for c, rows in enumerate(problem.rows(flight)):
            total[c] += effective_sample_size(residual[rows])
    return total


def log_prior_of(problem: EffectProblem, fitted: EffectFit, effective: FloatArray) -> float:
    """Return the log prior density of the fitted derivatives, given the aircraft file; 0 without a file."""
    if problem.prior_derivatives is None:
        return 0.0
    n = len(problem.prior_derivatives)
    known = covariance(problem, fitted, effective)[:n, :n]
    return log_prior(fitted.point.derivatives, known, problem.prior_derivatives)


def distance_from_file(problem: EffectProblem, fitted: EffectFit) -> Distance:
    """Return the distance of the fitted derivatives from the aircraft file's, or zero without a file."""
    if problem.prior_derivatives is None:
        return Distance(0.0, 0.0, -np.inf)
    n = len(problem.prior_derivatives)
    known = covariance(problem, fitted, effective_samples(problem, fitted.innovations))[:n, :n]
    return distance_of(fitted.point.derivatives, known, problem.prior_derivatives)


def shared_std(
    problem: EffectProblem, fitted: EffectFit, effective: FloatArray, trusted: bool = False
) -> FloatArray:
    """Return the standard deviations of the shared parameters, shape (k,); arguments are those of
    ``covariance``."""
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance(problem, fitted, effective, trusted)), 0.0)))


def sigmas_of(values: FloatArray, known: FloatArray, places: Sequence[bool]) -> float:
    """Return the largest number of standard deviations by which a parameter of an effect differs from zero.

    Parameters
    ----------
    values
        Shape (k,): parameters of an effect.
    known
        Shape (k, k): covariance of the parameters.
    places
        Whether each parameter is a position, time or rate instead of a size. Such parameters count as known:
        a step in a single manoeuvre has no certain size if it may be gradual, and exists all the same.
    """
    at = np.array(places)
    size, place = known[np.ix_(~at, ~at)], known[np.ix_(at, at)]
    across = known[np.ix_(~at, at)]
    given = size - across @ np.linalg.pinv(place, hermitian=True) @ across.T if np.any(at) else size
    std = np.sqrt(np.maximum(np.diag(given), 1e-300))
    return float(np.max(np.abs(values[~at]) / std))


def covariance(
    problem: EffectProblem, fitted: EffectFit, effective: FloatArray, trusted: bool = False
) -> FloatArray:
    """Return the covariance of the shared parameters, widened for coloured residuals, shape (k, k).

    The prior is not widened. With ``trusted`` the file's derivatives count as measured within their
    tolerance, for an effect that is correlated with them.
    """
    widened = float(np.mean(counts(problem) / np.maximum(effective, 1.0)))
    expected = problem.prior_of(fitted.point)[0]
    information = (fitted.information - np.diag(expected)) / widened + np.diag(expected)
    if trusted and problem.prior_derivatives is not None:
        n = len(problem.prior_derivatives)
        tolerance = prior_precision(problem.prior_derivatives, ERROR_IF_RIGHT)
        information[:n, :n] += np.diag(np.maximum(tolerance - expected[:n], 0.0))
    return inverse_of(information)[0]
