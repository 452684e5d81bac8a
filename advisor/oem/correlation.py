"""Correlation of parameters with each other."""

import numpy as np

from advisor.process.arrays import FloatArray

HIGH_CORRELATION = 0.9
"""Absolute correlation of two parameters above which a note is written."""


def correlation_matrix(covariance: FloatArray) -> FloatArray:
    """Scale a covariance to correlations.

    Parameters
    ----------
    covariance
        Shape (n, n), symmetric, any units.

    Returns
    -------
    ndarray
        Shape (n, n), from -1 to 1. Rows and columns of a parameter without positive variance are NaN.
    """
    variance = np.diag(covariance)
    known = np.isfinite(variance) & (variance > 0.0)
    scale = np.sqrt(np.where(known, variance, np.nan))
    return np.asarray(np.clip(covariance / np.outer(scale, scale), -1.0, 1.0))
