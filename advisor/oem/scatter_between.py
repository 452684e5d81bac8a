"""Errors that include the scatter between manoeuvres. A noise model of single manoeuvres lacks this scatter.

The influence of the measurements on a joint estimate is the sum of the manoeuvres' contributions. At the
optimum the contributions sum to zero. The scatter of the contributions is a covariance that is valid for any
error within a manoeuvre. The manoeuvres are the clusters of Liang & Zeger, *Biometrika* 73, 1986. A few
manoeuvres determine the scatter badly, so it replaces the stated error only if chance hardly explains the
difference.
"""

import numpy as np
from scipy.special import chdtri

from advisor.process.arrays import FloatArray

CHANCE = 0.05
"""Probability that a correctly stated error is widened."""


def widened_by_scatter(covariance: FloatArray, contributions: FloatArray) -> FloatArray:
    """Return the covariance with each error at least as large as the scatter of the manoeuvres requires.

    Parameters
    ----------
    covariance
        Shape (p, p): covariance from the noise within the manoeuvres.
    contributions
        Shape (m, p): contribution of each manoeuvre's residuals to each parameter.
    """
    maneuvers = len(contributions)
    stated = np.diag(covariance)
    if maneuvers < 2:
        return covariance
    scatter = np.sum(contributions**2, axis=0) * maneuvers / (maneuvers - 1)
    ratio = np.divide(scatter, stated, out=np.ones_like(stated), where=stated > 0.0)
    plain = (maneuvers - 1) * ratio > chdtri(maneuvers - 1, CHANCE)
    factor = np.where(plain, np.sqrt(np.maximum(ratio, 1.0)), 1.0)
    return np.asarray(covariance * np.outer(factor, factor))
