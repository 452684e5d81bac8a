"""Correlation of parameters with each other."""

import numpy as np

from advisor.process.arrays import FloatArray

HIGH_CORRELATION = 0.9
"""Absolute correlation of two parameters above which a note is written."""


def correlation_matrix(covariance: FloatArray) -> FloatArray:
    """Return the correlations (n, n) of a covariance (n, n); NaN for a parameter without variance."""
    variance = np.diag(covariance)
    scale = np.sqrt(np.where(np.isfinite(variance) & (variance > 0.0), variance, np.nan))
    return np.asarray(np.clip(covariance / np.outer(scale, scale), -1.0, 1.0))
