"""How well a fit knows its shared numbers, and what that says of the aircraft file's."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.prior import ERROR_IF_RIGHT, Distance, distance_of, log_prior, prior_precision
from advisor.gap.fitting.problem import Problem, counts
from advisor.gap.records.floor import effective_sample_size

CLEAR_GAP = 0.5
"""Gap of the file's own derivatives beside fitted ones from which on it takes less to call them wrong."""


def effective_samples(problem: Problem, residuals: Sequence[FloatArray]) -> FloatArray:
    """Shape (channels,): independent samples of each channel over all manoeuvres."""
    total = np.zeros(len(problem.channels))
    for flight, residual in zip(problem.flights.flights, residuals, strict=True):
        for c, rows in enumerate(problem.rows(flight)):
            total[c] += effective_sample_size(residual[rows])
    return total


def log_prior_of(problem: Problem, fitted: Fitted, effective: FloatArray) -> float:
    """Log probability of the derivatives, given the aircraft file; 0 without one."""
    if problem.prior_derivatives is None:
        return 0.0
    n = len(problem.prior_derivatives)
    known = covariance(problem, fitted, effective)[:n, :n]
    return log_prior(fitted.point.derivatives, known, problem.prior_derivatives)


def file_is_off(problem: Problem, fitted: Fitted, clear_gap: bool) -> bool:
    """Whether what was fitted says that the aircraft file's derivatives are wrong; see ``distance_of``."""
    return distance_from_file(problem, fitted, clear_gap).is_off


def distance_from_file(problem: Problem, fitted: Fitted, clear_gap: bool) -> Distance:
    """How far the fitted derivatives are from the aircraft file's; none without a file."""
    if problem.prior_derivatives is None:
        return Distance(0.0, np.inf)
    n = len(problem.prior_derivatives)
    known = covariance(problem, fitted, effective_samples(problem, fitted.innovations))[:n, :n]
    return distance_of(fitted.point.derivatives, known, problem.prior_derivatives, clear_gap)


def shared_std(problem: Problem, fitted: Fitted, effective: FloatArray, trusted: bool = False) -> FloatArray:
    """Shape (k,): standard deviations of the shared numbers; arguments as ``covariance``."""
    return np.asarray(np.sqrt(np.maximum(np.diag(covariance(problem, fitted, effective, trusted)), 0.0)))


def sigmas_of(values: FloatArray, known: FloatArray, places: Sequence[bool]) -> float:
    """Standard deviations by which the size of an effect differs from nothing, the largest of its numbers.

    Parameters
    ----------
    values
        Shape (k,): numbers of an effect.
    known
        Shape (k, k): their covariance.
    places
        Which of them say where, when or how fast, not how much. They count as known: a step that a single
        manoeuvre shows has no size of its own if it may have come gradually, and is there all the same.
    """
    at = np.array(places)
    size, place = known[np.ix_(~at, ~at)], known[np.ix_(at, at)]
    across = known[np.ix_(~at, at)]
    given = size - across @ np.linalg.pinv(place, hermitian=True) @ across.T if np.any(at) else size
    std = np.sqrt(np.maximum(np.diag(given), 1e-300))
    return float(np.max(np.abs(values[~at]) / std))


def covariance(problem: Problem, fitted: Fitted, effective: FloatArray, trusted: bool = False) -> FloatArray:
    """Shape (k, k): covariance of the shared numbers, widened for coloured residuals.

    What is expected beforehand is not. Where the file's derivatives are trusted, they count as measured
    within their tolerance: that is how well an effect is known that trades against them.
    """
    widened = float(np.mean(counts(problem) / np.maximum(effective, 1.0)))
    expected = problem.prior_of(fitted.point)[0]
    information = (fitted.information - np.diag(expected)) / widened + np.diag(expected)
    if trusted and problem.prior_derivatives is not None:
        n = len(problem.prior_derivatives)
        tolerance = prior_precision(problem.prior_derivatives, ERROR_IF_RIGHT)
        information[:n, :n] += np.diag(np.maximum(tolerance - expected[:n], 0.0))
    scale = np.sqrt(np.maximum(np.diag(information), 1e-300))
    normal = information / np.outer(scale, scale)
    return np.asarray(np.linalg.pinv(normal, rcond=1e-12, hermitian=True) / np.outer(scale, scale))
