"""Uncertainty of the shared parameters, and the distance of the fit from the aircraft file."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, Distance, distance_of, prior_precision
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
    """Return the standard deviations of the shared parameters, shape (k,), as ``covariance`` does."""
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance(problem, fitted, effective, trusted)), 0.0)))


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
