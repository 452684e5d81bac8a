"""Errors that contain the scatter between manoeuvres: what no model of the noise within one manoeuvre knows.

The influence of the measurements on a joint estimate splits into one contribution of each manoeuvre. At the
optimum the contributions sum to zero; their scatter is the covariance that holds whatever the errors within
a manoeuvre are, model error included (Liang & Zeger, *Biometrika* 73, 1986: clusters are manoeuvres). From
few manoeuvres that scatter is known badly, so that it takes the place of the stated error only where chance
hardly explains the difference.
"""

import numpy as np
from scipy.special import chdtri

from advisor.flight.messages import FloatArray

CHANCE = 0.05
"""Of widening an error that is stated rightly."""


def widened_by_scatter(covariance: FloatArray, contributions: FloatArray) -> FloatArray:
    """Return the covariance, each error at least as large as the manoeuvres' scatter makes plain.

    Parameters
    ----------
    covariance
        Shape (p, p), as the noise within the manoeuvres has it.
    contributions
        Shape (m, p): how far each manoeuvre's residuals pull each parameter.
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
