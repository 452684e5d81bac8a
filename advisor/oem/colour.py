"""Colour of an output's noise: white noise plus a first-order autoregression, fitted by restricted
likelihood.

    ν_k = w_k + x_k,   x_{k+1} = φ·x_k + e_k

Residuals of real flights are a mixture of white sensor noise and small, slow model errors. Sample
autocorrelations of residuals are too small, because the fitted parameters absorb part of the slow noise.
Restricted maximum likelihood (Patterson & Thompson, *Biometrika* 58, 1971) has no such bias, because it uses
only what no parameter can explain.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from advisor.oem.restricted import restricted
from advisor.oem.running_sums import accumulated
from advisor.process.arrays import FloatArray

MEMORIES = (-0.4, 0.3, 0.5, 0.7, 0.8, 0.87, 0.92, 0.95, 0.97, 0.985, 0.993)
"""Starting values of φ in the search."""
WHITE_SHARES = (0.0, 0.1, 0.5, 2.0)
"""Starting values of var w / var x in the search."""
SIGNIFICANT = 6.0
"""Least gain in twice the log likelihood of coloured over white noise."""
PROMISING = 1.0
"""Least gain of the best starting value with which the search starts."""
LARGEST_MEMORY = 0.9995
SMALLEST_SHARE = 1e-4
LOG_SMALLEST_SHARE = math.log(SMALLEST_SHARE)
_NEARLY_ONE = 1.0 - 1e-9
_ROUND_OFF = float(np.finfo(float).eps)
"""Least residual power per degree of freedom, relative to the mean square before the regression."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Residuals of one output in one manoeuvre, with the regressors of its parameters."""

    residual: FloatArray
    """Shape (n,): residuals of the output."""
    columns: FloatArray
    """Shape (n, p): derivatives of the output by the manoeuvre's parameters."""


@dataclass(frozen=True, slots=True)
class Colour:
    """Noise model of one output."""

    variance: float
    """Variance of the coloured part x, or of the whole noise if ``memory`` is 0."""
    memory: float
    """Correlation φ of successive samples of the coloured part; 0 for white noise."""
    white_share: float
    """Ratio of the white noise's variance to the coloured part's, var w / var x."""
    uncertainty: FloatArray
    """Shape (k, k): covariance of log ``variance`` and, for coloured noise, of ``shape``."""

    @property
    def shape(self) -> FloatArray:
        """Shape (2,): φ and var w / var x, transformed to unbounded scales."""
        return _unbounded(self.memory, self.white_share)


def find_colour(stretches: Sequence[Stretch]) -> Colour:
    """Fit the noise model to residuals of one output, pooled over manoeuvres."""
    scale = float(np.sqrt(np.mean(np.concatenate([s.residual for s in stretches]) ** 2)))
    if scale == 0.0:
        return Colour(0.0, 0.0, 0.0, np.zeros((1, 1)))
    prepared = [_orthogonal(s, scale) for s in stretches]
    freedom = sum(max(len(block) - block.shape[1] + 1, 1) for block in prepared)

    def pooled(memory: float, share: float) -> tuple[float, float]:
        parts = [restricted(block, memory, share) for block in prepared]
        # A residual that the columns explain whole is left with round-off, of either sign.
        power = max(sum(power for power, _ in parts), freedom * _ROUND_OFF)
        return power, sum(determinant for _, determinant in parts)

    def cost(memory: float, share: float) -> tuple[float, float]:
        power, determinants = pooled(memory, share)
        return float(freedom * np.log(power / freedom) + determinants), power / freedom

    white, variance = cost(0.0, 0.0)
    plain = Colour(scale**2 * variance, 0.0, 0.0, np.array([[2.0 / freedom]]))
    guesses = [(cost(memory, 0.0)[0], memory, 0.0) for memory in MEMORIES]
    best = min(guesses)
    guesses += [(cost(best[1], share)[0], best[1], share) for share in WHITE_SHARES[1:]]
    slower = min(0.99, 0.5 + best[1] / 2.0)
    guesses += [(cost(slower, share)[0], slower, share) for share in WHITE_SHARES[1:]]
    reached, memory, share = min(guesses)
    if white - reached < PROMISING:
        return plain

    def by_shape(x: FloatArray) -> float:
        return cost(*_bounded(x))[0]

    found = minimize(
        by_shape,
        _unbounded(memory, share),
        method="Nelder-Mead",
        options={"xatol": 2e-2, "fatol": 2e-2, "initial_simplex": _simplex(_unbounded(memory, share))},
    )
    memory, share = _bounded(found.x)
    if white - float(found.fun) < SIGNIFICANT:
        return plain
    variance = cost(memory, share)[1]

    def joint(x: FloatArray) -> float:
        """Return -2·log-likelihood of the residuals for log variance and shape."""
        power, determinants = pooled(*_bounded(x[1:]))
        return float(freedom * x[0] + power * np.exp(-x[0]) + determinants)

    centre = np.concatenate([[np.log(variance)], _unbounded(memory, share)])
    return Colour(scale**2 * variance, memory, share, _uncertainty(joint, centre))


def product(rows: FloatArray, colour: Colour) -> FloatArray:
    """Return AᵀΓA, shape (k, k), for the influence ``rows`` (n, k) of one stretch."""
    square = rows.T @ rows
    if colour.memory == 0.0:
        return colour.variance * square
    forward = rows.T @ accumulated(rows, colour.memory)
    total: FloatArray = colour.variance * (forward + forward.T - square + colour.white_share * square)
    return total


def powers(rows: FloatArray, colour: Colour) -> FloatArray:
    """Return the diagonal of ``product``, shape (k,)."""
    square = np.einsum("ij,ij->j", rows, rows)
    if colour.memory == 0.0:
        return np.asarray(colour.variance * square)
    forward = np.einsum("ij,ij->j", rows, accumulated(rows, colour.memory))
    return np.asarray(colour.variance * (2.0 * forward - square + colour.white_share * square))


def moved(colour: Colour, step: FloatArray) -> Colour:
    """Return the colour with log variance and shape changed by ``step`` (3,)."""
    memory, share = _bounded(colour.shape + step[1:])
    return Colour(colour.variance * float(np.exp(step[0])), memory, share, colour.uncertainty)


def _bounded(x: FloatArray) -> tuple[float, float]:
    return LARGEST_MEMORY * math.tanh(x[0]), math.exp(min(max(x[1], LOG_SMALLEST_SHARE), 9.0))


def _unbounded(memory: float, share: float) -> FloatArray:
    inside = float(np.clip(memory / LARGEST_MEMORY, -_NEARLY_ONE, _NEARLY_ONE))
    return np.array([np.arctanh(inside), np.log(max(share, SMALLEST_SHARE))])


def _simplex(x: FloatArray) -> FloatArray:
    corners: FloatArray = x + np.array([[0.0, 0.0], [0.15, 0.0], [0.0, 1.0]])
    return corners


def _orthogonal(stretch: Stretch, scale: float) -> FloatArray:
    """Return an orthonormal basis of the columns with the residual as last column, shape (n, r + 1)."""
    columns = stretch.columns / np.where(np.any(stretch.columns != 0.0, axis=0), 1.0, np.inf)
    size = np.linalg.norm(columns, axis=0)
    basis, values, _ = np.linalg.svd(columns[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return np.ascontiguousarray(
        np.column_stack([basis[:, values > 1e-9 * values[0]], stretch.residual / scale])
    )


def _uncertainty(cost: Callable[[FloatArray], float], centre: FloatArray) -> FloatArray:
    """Return the covariance of the noise parameters from the curvature of -2·log-likelihood."""
    n = len(centre)
    steps = np.array([0.05, 0.05, 0.3])
    hessian = np.empty((n, n))
    for i in range(n):
        for j in range(i + 1):
            a, b = np.eye(n)[i] * steps[i], np.eye(n)[j] * steps[j]
            mixed = cost(centre + a + b) - cost(centre + a - b) - cost(centre - a + b) + cost(centre - a - b)
            hessian[i, j] = hessian[j, i] = mixed / (8.0 * steps[i] * steps[j])
    values, vectors = np.linalg.eigh(hessian)
    covariance: FloatArray = (vectors / np.maximum(values, 0.05)) @ vectors.T
    return covariance
