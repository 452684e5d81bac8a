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
from typing import Self

import numpy as np

from advisor.oem.restricted import LARGEST_MEMORY, SMALLEST_SHARE, bounded, likeliest, restricted
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
    residuals = _Residuals.of(stretches, scale)
    white, variance = residuals.cost(0.0, 0.0)
    plain = Colour(scale**2 * variance, 0.0, 0.0, np.array([[2.0 / residuals.freedom]]))
    guesses = [(residuals.cost(memory, 0.0)[0], memory, 0.0) for memory in MEMORIES]
    best = min(guesses)
    guesses += [(residuals.cost(best[1], share)[0], best[1], share) for share in WHITE_SHARES[1:]]
    slower = min(0.99, 0.5 + best[1] / 2.0)
    guesses += [(residuals.cost(slower, share)[0], slower, share) for share in WHITE_SHARES[1:]]
    reached, memory, share = min(guesses)
    if white - reached < PROMISING:
        return plain
    shape, least = residuals.likeliest(_unbounded(memory, share))
    if white - least < SIGNIFICANT:
        return plain
    memory, share = bounded(*shape)
    variance = residuals.cost(memory, share)[1]

    def joint(x: FloatArray) -> float:
        """Return -2·log-likelihood of the residuals for log variance and shape."""
        power, determinants = residuals.pooled(*bounded(x[1], x[2]))
        return float(residuals.freedom * x[0] + power * np.exp(-x[0]) + determinants)

    centre = np.concatenate([[np.log(variance)], shape])
    return Colour(scale**2 * variance, memory, share, _uncertainty(joint, centre))


class _Residuals:
    """Residuals of one output in all manoeuvres, with an orthonormal basis of each manoeuvre's columns."""

    def __init__(self, blocks: Sequence[FloatArray]) -> None:
        self.freedom = sum(max(len(block) - block.shape[1] + 1, 1) for block in blocks)
        """Number of samples that no parameter explains."""
        self._floor = self.freedom * _ROUND_OFF
        """Least residual power. Of a residual that the columns explain wholly, round-off of either sign
        remains.
        """
        self._sizes = np.array([block.shape for block in blocks], np.int64)
        self._flat = np.concatenate([block.ravel() for block in blocks])
        self._pooled: dict[tuple[float, float], tuple[float, float]] = {}

    @classmethod
    def of(cls, stretches: Sequence[Stretch], scale: float) -> Self:
        """Return the residuals over ``scale``."""
        return cls([_orthogonal(stretch, scale) for stretch in stretches])

    def pooled(self, memory: float, share: float) -> tuple[float, float]:
        """Return residual power and log determinants of all manoeuvres, as ``restricted`` does of one."""
        if (memory, share) not in self._pooled:
            power, determinants = restricted(self._flat, self._sizes, memory, share)
            self._pooled[memory, share] = max(power, self._floor), determinants
        return self._pooled[memory, share]

    def cost(self, memory: float, share: float) -> tuple[float, float]:
        """Return -2·log-likelihood at the likeliest variance, and this variance."""
        power, determinants = self.pooled(memory, share)
        return self.freedom * math.log(power / self.freedom) + determinants, power / self.freedom

    def likeliest(self, begin: FloatArray) -> tuple[FloatArray, float]:
        """Return the likeliest shape (2,) near a start, and its -2·log-likelihood."""
        *shape, least = likeliest(self._flat, self._sizes, self.freedom, self._floor, *begin)
        return np.array(shape), least


def product(rows: FloatArray, colour: Colour) -> FloatArray:
    """Return AᵀΓA, shape (k, k), for the influence ``rows`` (n, k) of one stretch."""
    square = rows.T @ rows
    if colour.memory == 0.0:
        return colour.variance * square
    forward = rows.T @ accumulated(np.ascontiguousarray(rows), colour.memory)
    return np.asarray(colour.variance * (forward + forward.T - square + colour.white_share * square))


def powers(rows: FloatArray, colour: Colour) -> FloatArray:
    """Return the diagonal of ``product``, shape (k,)."""
    square = np.einsum("ij,ij->j", rows, rows)
    if colour.memory == 0.0:
        return np.asarray(colour.variance * square)
    forward = np.einsum("ij,ij->j", rows, accumulated(np.ascontiguousarray(rows), colour.memory))
    return np.asarray(colour.variance * (2.0 * forward - square + colour.white_share * square))


def moved(colour: Colour, step: FloatArray) -> Colour:
    """Return the colour with log variance and shape changed by ``step`` (3,)."""
    memory, share = bounded(*(colour.shape + step[1:]))
    return Colour(colour.variance * float(np.exp(step[0])), memory, share, colour.uncertainty)


def _unbounded(memory: float, share: float) -> FloatArray:
    inside = float(np.clip(memory / LARGEST_MEMORY, -_NEARLY_ONE, _NEARLY_ONE))
    return np.array([np.arctanh(inside), np.log(max(share, SMALLEST_SHARE))])


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
    return np.asarray((vectors / np.maximum(values, 0.05)) @ vectors.T)
