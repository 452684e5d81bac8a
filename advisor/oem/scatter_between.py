"""Errors that include the scatter between manoeuvres and between their parts.

The influence of the measurements on a joint estimate is the sum of the contributions of all parts. At the
optimum the contributions sum to zero. Their scatter is a covariance that is valid for any error within a
part, also for a force, which is one noise in several outputs. The parts are the clusters of Liang & Zeger,
*Biometrika* 73, 1986. A few parts determine the scatter badly, so it replaces the stated error only if chance
hardly explains the difference.
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
        Shape (m, p) or (m, parts, p): contribution of each manoeuvre to each parameter, in a power of two
        of equally long parts.
    """
    stated = np.where(np.diag(covariance) > 0.0, np.diag(covariance), np.inf)
    parts = np.reshape(contributions, (len(contributions), -1, len(stated)))
    finer = range(parts.shape[1].bit_length() - 1)
    factor = np.ones_like(stated)
    for joined, chance in ((parts.shape[1], CHANCE), *((2**k, CHANCE / len(finer)) for k in finer)):
        clusters = parts.reshape(-1, joined, len(stated)).sum(axis=1)
        others = len(clusters) - 1
        ratio = np.sum(clusters**2, axis=0) * len(clusters) / max(others, 1) / stated
        plain = others * ratio > chdtri(max(others, 1), chance)
        factor = np.maximum(factor, np.where(plain, np.sqrt(np.maximum(ratio, 1.0)), 1.0))
    return np.asarray(covariance * np.outer(factor, factor))
