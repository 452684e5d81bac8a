"""Closed integral over derivatives and parameters, with each derivative of the file right or wrong."""

from typing import NamedTuple

import numpy as np

from advisor.gap.inference.explanation import Evidence
from advisor.process.arrays import FloatArray


class Prior(NamedTuple):
    """Gaussian prior of derivatives and parameters."""

    precision: FloatArray
    """Shape (k,): inverse prior variances."""
    pull: FloatArray
    """Shape (k,): prior means minus the values of a fit."""


def marginal(
    likelihood: float, information: FloatArray, gradient: FloatArray, right: Prior, wrong: Prior
) -> Evidence:
    """Return the log marginal likelihood with all derivatives right, and with some of them wrong.

    Where the two priors differ, the file states a derivative, which is integrated as right and as wrong. All
    derivatives of the file are right in half of the flights.

    Parameters
    ----------
    information, gradient
        Shapes (k, k) and (k,): curvature and slope of the log likelihood at the fit, without a prior.
    """
    stated = right.precision != wrong.precision
    others, both = np.flatnonzero(~stated), np.flatnonzero(stated)
    own, pull = right.precision[others], right.pull[others]
    block, end = information[np.ix_(others, others)] + np.diag(own), gradient[others] + own * pull
    across = information[np.ix_(others, both)]
    carried = np.linalg.solve(block, np.column_stack([across, end]))
    gained = np.sum(np.log(own)) - np.linalg.slogdet(block)[1] + end @ carried[:, -1] - own @ pull**2
    total = np.full(1, likelihood + 0.5 * gained)
    matrix = (information[np.ix_(both, both)] - across.T @ carried[:, :-1])[None]
    slope = (gradient[both] - across.T @ carried[:, -1])[None]
    one_right = -np.log(2.0) / max(len(both), 1)
    shares = one_right, np.log(-np.expm1(one_right))
    for at in both:
        parts = []
        for prior, share in zip((right, wrong), shares, strict=True):
            precision, pull = prior.precision[at], prior.pull[at]
            pivot, end = matrix[:, 0, 0] + precision, slope[:, 0] + precision * pull
            gained = share + 0.5 * (np.log(precision / pivot) + end**2 / pivot - precision * pull**2)
            column = matrix[:, 1:, 0]
            carried = column / pivot[:, None]
            parts.append((
                total + gained,
                slope[:, 1:] - carried * end[:, None],
                matrix[:, 1:, 1:] - column[:, :, None] * carried[:, None, :],
            ))  # fmt: skip
        total, slope, matrix = (np.concatenate(part) for part in zip(*parts, strict=True))
    if len(total) == 1:
        return Evidence(float(total[0]), float(total[0]))
    # The first way has no wrong derivative.
    return Evidence(float(total[0]), float(np.logaddexp.reduce(total[1:]))).more(float(np.log(2.0)))
