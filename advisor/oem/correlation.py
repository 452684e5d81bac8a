"""Correlation of residuals in time, and of parameters with each other."""

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.words.quantiles import NORMAL_95

HIGH_CORRELATION = 0.9
"""Absolute correlation of two parameters above which a note is written."""


def autocorrelation(residual: FloatArray, lags: int) -> FloatArray:
    """Return the autocorrelation of a residual at whole numbers of samples.

    The estimate is biased: r_k = Σ v_i v_{i+k} / Σ v_i². Here v is the residual less its mean.
    Source: Box, Jenkins and Reinsel, *Time Series Analysis*, section 2.1. Samples are treated as evenly
    spaced.

    Parameters
    ----------
    residual
        Shape (n,), any unit; samples that are not finite are left out.
    lags
        The largest lag in samples, at least 0.

    Returns
    -------
    ndarray
        Shape (m + 1,), r_0 to r_m with m = min(lags, n - 1); r_0 is 1. All values are 0 for a constant
        residual.
    """
    finite = residual[np.isfinite(residual)]
    if len(finite) == 0:
        return np.zeros(1)
    v = finite - np.mean(finite)
    most = min(lags, len(v) - 1)
    power = float(v @ v)
    if power <= 0.0:
        return np.zeros(most + 1)
    return np.array([float(v[k:] @ v[: len(v) - k]) for k in range(most + 1)]) / power


def white_noise_bound(samples: int) -> float:
    """Return the half-width of the 95 % band of the autocorrelation of white noise: 1.96/√N.

    Parameters
    ----------
    samples
        Number N of samples, at least 1.
    """
    return float(NORMAL_95 / np.sqrt(samples))


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
    correlation: FloatArray = np.clip(covariance / np.outer(scale, scale), -1.0, 1.0)
    return correlation
