"""Normal equations of one manoeuvre's own numbers: factored once, solved often, with little ado."""

import numpy as np
from scipy.linalg.lapack import dpotrf, dpotrs

from advisor.flight.messages import FloatArray


def factored(normal: FloatArray) -> FloatArray:
    """Lower Cholesky factor of a symmetric positive definite matrix, shape (m, m).

    Raises
    ------
    np.linalg.LinAlgError
        The matrix is not positive definite, or holds something that is no number.
    """
    factor, info = dpotrf(normal, lower=1, clean=0)
    if info != 0 or not np.isfinite(factor[-1, -1]):
        raise np.linalg.LinAlgError("the manoeuvre's own numbers are not determined")
    return np.asarray(factor)


def solved(factor: FloatArray, right: FloatArray) -> FloatArray:
    """Solution for a right-hand side, shape (m,) or (m, k)."""
    return np.asarray(dpotrs(factor, right, lower=1)[0])
