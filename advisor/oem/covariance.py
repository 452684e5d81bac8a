"""How far to trust an estimate: the Cramér-Rao bound, and its correction for coloured residuals.

Near the optimum the estimate is linear in the noise, θ̂ - θ = Aᵀ·ν, with the influence A of
every measurement. White noise of covariance R gives AᵀRA, which is the Cramér-Rao bound. Real
residuals are coloured; then the covariance is AᵀΓA with Γ the noise's own autocorrelation,
estimated from the residuals: Klein & Morelli, *Aircraft System Identification* (2006),
Eqs. (5.42)-(5.46).
"""

from dataclasses import dataclass

import numpy as np

from advisor.aircraft import PARAMETERS
from advisor.flight.messages import FloatArray
from advisor.model.response import LOCAL, N_SHARED, SHARED
from advisor.oem.problem import Assembly

LEAST_EIGENVALUE = 1e-13
"""Of a normalised information matrix; below, round-off decides the inverse."""
REPORTED = tuple((name in SHARED, (SHARED if name in SHARED else LOCAL).index(name)) for name in PARAMETERS)
"""Where each of the eight stands: (shared or local, index)."""


@dataclass(frozen=True, slots=True)
class Influence:
    """The linear map from measurements to the eight parameters."""

    rows: FloatArray
    """(N, 8) change of each parameter for a unit change of each measurement."""
    condition: float
    """Condition number of the information matrix of the eight, normalised to a unit diagonal."""
    inflation: FloatArray
    """(8,) variance of each parameter over what it would be were all others known."""


def influence(assembly: Assembly, g: FloatArray, noise: FloatArray) -> Influence | None:
    """Influence of every measurement on the eight parameters; None when the information is singular.

    Z_0 and M_0 are means over the manoeuvres.
    """
    weight = 1.0 / noise[assembly.channel] ** 2
    own = assembly.free[N_SHARED:]
    parts = []
    projected = np.empty((len(g), N_SHARED))
    try:
        for m, named in enumerate(assembly.rows):
            rows = slice(min(s.start for s in named.values()), max(s.stop for s in named.values()))
            weighted = (g[rows][:, own] * weight[rows, None]).T
            inverse = _inverse(weighted @ g[rows][:, own])
            gain = inverse @ weighted
            mix = gain @ g[rows, :N_SHARED]
            projected[rows] = g[rows, :N_SHARED] - g[rows][:, own] @ mix
            parts.append((m, rows, gain, mix))
        information = projected.T @ (projected * weight[:, None])
        shared = projected * weight[:, None] @ _inverse(information)
    except np.linalg.LinAlgError:
        return None
    result = np.zeros((len(g), len(PARAMETERS)))
    for j, (is_shared, index) in enumerate(REPORTED):
        if is_shared:
            result[:, j] = shared[:, index]
            continue
        at = int(np.flatnonzero(own == N_SHARED + index)[0])
        for _, rows, gain, mix in parts:
            result[rows, j] += gain[at] / len(parts)
            result[:, j] -= shared @ mix[at] / len(parts)
    covariance = (result / weight[:, None]).T @ result
    scale = np.sqrt(np.diag(covariance))
    if not np.all(np.isfinite(scale)) or not np.all(scale > 0.0):
        return None
    correlation = covariance / np.outer(scale, scale)
    inverse = np.linalg.pinv(correlation, hermitian=True)
    return Influence(result, float(np.linalg.cond(correlation)), np.diag(inverse).copy())


def _inverse(information: FloatArray) -> FloatArray:
    """Inverse of a symmetric matrix; LinAlgError when it is not positive definite to working precision."""
    diagonal = np.diag(information)
    if not np.all(diagonal > 0.0):
        raise np.linalg.LinAlgError
    scale = 1.0 / np.sqrt(diagonal)
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    if not values[0] > LEAST_EIGENVALUE:
        raise np.linalg.LinAlgError
    result: FloatArray = (vectors / values) @ vectors.T * np.outer(scale, scale)
    return result


def cramer_rao(assembly: Assembly, rows: FloatArray, noise: FloatArray) -> FloatArray:
    """AᵀRA, shape (8, 8)."""
    return (rows * noise[assembly.channel, None] ** 2).T @ rows


def coloured(assembly: Assembly, rows: FloatArray, residual: FloatArray) -> FloatArray:
    """AᵀΓA, shape (8, 8), with the autocovariance of each output pooled over the manoeuvres."""
    total = np.zeros((rows.shape[1], rows.shape[1]))
    for output in {name for named in assembly.rows for name in named}:
        stretches = [named[output] for named in assembly.rows if output in named]
        reach = max(2, max(s.stop - s.start for s in stretches) // 5)
        power = np.zeros(reach)
        cross = np.zeros((reach, *total.shape))
        for s in stretches:
            v, a = residual[s], rows[s]
            for k in range(min(reach, len(v))):
                power[k] += v[k:] @ v[: len(v) - k]
                cross[k] += a[k:].T @ a[: len(a) - k]
        autocovariance = power / sum(s.stop - s.start for s in stretches)
        for k in range(reach):
            total += autocovariance[k] * (cross[k] if k == 0 else cross[k] + cross[k].T)
    return total
