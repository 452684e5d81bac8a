"""Inverses of covariance and information matrices with unknown parameters.

``covariance_of`` and ``information_of`` accept one matrix or a stack of matrices.
"""

import numpy as np

from advisor.process.arrays import FloatArray


def information_of(covariance: FloatArray) -> FloatArray:
    """Return the inverse of covariances (..., n, n), with zero rows and columns for unknown parameters.

    A parameter is unknown if its variance is not finite and positive.
    """
    variance = np.diagonal(covariance, axis1=-2, axis2=-1)
    return _inverse(covariance, np.isfinite(variance) & (variance > 0.0), 0.0)


def covariance_of(information: FloatArray) -> FloatArray:
    """Return the inverse of information matrices (..., n, n), with infinite variance for parameters without
    information."""
    return _inverse(information, np.diagonal(information, axis1=-2, axis2=-1) > 0.0, np.inf)


def _inverse(matrix: FloatArray, is_known: np.ndarray, unknown: float) -> FloatArray:
    """Return inverses of symmetric matrices (..., n, n): unknown rows zero, ``unknown`` on the diagonal."""
    inside = is_known[..., :, None] & is_known[..., None, :]
    identity = np.eye(matrix.shape[-1])
    scale = 1.0 / np.sqrt(np.where(is_known, np.diagonal(matrix, axis1=-2, axis2=-1), 1.0))
    outer = scale[..., :, None] * scale[..., None, :]
    scaled = np.where(inside, matrix * outer, identity)
    try:
        half = np.linalg.inv(np.linalg.cholesky(scaled))
        inverse = np.swapaxes(half, -2, -1) @ half
    except np.linalg.LinAlgError:
        if matrix.ndim > 2:
            return np.array([_inverse(m, k, unknown) for m, k in zip(matrix, is_known, strict=True)])
        inverse = np.linalg.pinv(scaled, hermitian=True)
    without = np.where((identity > 0.0) & ~is_known[..., None], unknown, 0.0)
    return np.where(inside, inverse * outer, without)
