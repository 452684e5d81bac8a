"""Normal equations: of the nuisance parameters, factored once; of the shared parameters, within their
bounds."""

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from advisor.flight.signals.messages import FloatArray

_SOUND = 1e-2
"""Least pivot of a matrix with unit diagonal that shows it to be well conditioned: no singular value is below
its square."""


def factored(normal: FloatArray) -> FloatArray:
    """Return the lower Cholesky factor of a symmetric positive definite matrix, shape (m, m).

    Raises
    ------
    np.linalg.LinAlgError
        The matrix is not positive definite, or contains a NaN or an infinity.
    """
    factor, info = dpotrf(normal, lower=1, clean=0)
    if info != 0 or not np.isfinite(factor[-1, -1]):
        raise np.linalg.LinAlgError("the data do not determine the manoeuvre's trim and initial state")
    return np.asarray(factor)


def solved(factor: FloatArray, right: FloatArray) -> FloatArray:
    """Return the solution for a right-hand side, shape (m,) or (m, k)."""
    return np.asarray(dpotrs(factor, right, lower=1)[0])


def solved_within(
    H: FloatArray, g: FloatArray, least: FloatArray, most: FloatArray, indifferent: float = 1e-12
) -> FloatArray:
    """Return the x that minimises ½ xᵀHx − gᵀx with ``least`` ≤ x ≤ ``most``, all of shape (k,).

    A component that would leave its range is fixed at the end of the range, and the others are solved for
    again. Clipping the solution instead would lead away from the optimum where parameters are correlated. H
    is scaled to a unit diagonal. Directions with relative singular values below ``indifferent`` are not
    moved.
    """
    scale = np.sqrt(np.maximum(np.diag(H), 1e-300))
    normal, right = H / np.outer(scale, scale), g / scale
    x = _solution(normal, right, indifferent) / scale
    free = np.ones(len(g), dtype=bool)
    while np.any(outside := free & ((x < least) | (x > most))):
        x[outside] = np.clip(x, least, most)[outside]
        free &= ~outside
        if not np.any(free):
            break
        with_them = right[free] - normal[np.ix_(free, ~free)] @ (x * scale)[~free]
        x[free] = _solution(normal[np.ix_(free, free)], with_them, indifferent) / scale[free]
    return x


def _solution(normal: FloatArray, right: FloatArray, indifferent: float) -> FloatArray:
    """Return the solution for a matrix with unit diagonal; singular values are computed only where some may
    be tiny."""
    factor, info = dpotrf(normal, lower=1, clean=0)
    if info == 0 and np.min(np.diag(factor)) > _SOUND:
        return solved(factor, right)
    return np.asarray(np.linalg.lstsq(normal, right, rcond=indifferent)[0])
