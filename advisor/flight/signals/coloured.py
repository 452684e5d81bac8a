"""Errors of a least-squares fit with coloured residuals, whose neighbours are correlated."""

import numpy as np

from advisor.flight.signals.messages import FloatArray

_SMALLEST = 1e-15**0.5
"""Singular value of a Jacobian, over the largest one, at which round-off decides. JᵀJ then has the
precision of a double."""


def inverse_information(jacobian: FloatArray) -> FloatArray:
    """Return (JᵀJ)⁻¹ of a Jacobian (n, p), without the directions that round-off decides.

    The product of a root with itself has no negative variance; the inverse of a nearly singular JᵀJ may.
    """
    root = np.linalg.pinv(jacobian, rcond=_SMALLEST)
    return np.asarray(root @ root.T)


def coloured_covariance(jacobian: FloatArray, residual: FloatArray) -> FloatArray:
    """Return the covariance of a least-squares fit with coloured residuals.

    (JᵀJ)⁻¹ (Σ_ij R(i−j) J_iᵀ J_j) (JᵀJ)⁻¹ with the residuals' own autocovariance R (Klein & Morelli, Eq. 6.38
    f.). R is tapered to zero at a fifth of the record.

    Parameters
    ----------
    jacobian
        Shape (n, p).
    residual
        Shape (n,), sampled nearly evenly, so that lags mean times.
    """
    n = len(residual)
    inverse = inverse_information(jacobian)
    lags = max(1, n // 5)
    inner = float(residual @ residual) / n * (jacobian.T @ jacobian)
    for k in range(1, lags):
        weight = (1.0 - k / lags) * float(residual[k:] @ residual[:-k]) / n
        cross = jacobian[k:].T @ jacobian[:-k]
        inner = inner + weight * (cross + cross.T)
    plain = float(residual @ residual) / max(n - jacobian.shape[1], 1) * inverse
    # The tapered sum may fall below the white-noise value by chance. Such a small value is not used.
    wider = np.sqrt(np.maximum(np.diag(inverse @ inner @ inverse) / np.maximum(np.diag(plain), 1e-300), 1.0))
    return np.asarray(plain * np.outer(wider, wider))
