"""Whitening filter for noise that is white plus a first-order autoregression.

    ν_k = w_k + x_k,   x_{k+1} = φ·x_k + e_k,   var x = 1,   var w = share

With Γ = L·Lᵀ the autocovariance of ν, L⁻¹·ν are the scaled innovations of a scalar Kalman filter over ν. The
source is Harvey, *Forecasting, Structural Time Series Models and the Kalman Filter*, section 3.4. The filter
starts with the stationary variance of x, so it needs no time to settle.
"""

from dataclasses import dataclass

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

STEADY = 1e-15
"""Numerical: relative change of a variance from one sample to the next below which the filter is steady."""


@dataclass(frozen=True, slots=True)
class Whitening:
    """Factor L⁻¹ for one stretch of successive samples."""

    memory: float
    """Correlation φ of successive samples of x."""
    scale: FloatArray
    """Shape (n,): reciprocal of each innovation's standard deviation."""
    gain: FloatArray
    """Shape (n,): gain of the state for each innovation."""

    @classmethod
    def of(cls, samples: int, memory: float, white_share: float, variance: float = 1.0) -> "Whitening":
        """Return the whitening filter for ``samples`` samples of noise whose coloured part has
        ``variance``."""
        scale, gain, _ = schedule(samples, memory, white_share)
        return cls(memory, scale / np.sqrt(variance), gain)

    def forward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻¹·rows, shape (n, k)."""
        return whiten(np.ascontiguousarray(rows), self.memory, self.scale, self.gain).T

    def backward(self, rows: FloatArray) -> FloatArray:
        """Return L⁻ᵀ·rows, shape (n, k)."""
        return whiten_adjoint(np.ascontiguousarray(rows), self.memory, self.scale, self.gain)


@kernel()
def schedule(samples: int, memory: float, white_share: float) -> tuple[FloatArray, FloatArray, float]:
    """Return ``scale`` and ``gain`` of a ``Whitening`` with var x = 1, and log det Γ."""
    scale, gain = np.empty(samples), np.empty(samples)
    log_determinant = 0.0
    predicted = 1.0
    for i in range(samples):
        total = predicted + white_share
        scale[i] = 1.0 / np.sqrt(total)
        gain[i] = memory * predicted / total
        later = memory * memory * predicted * (1.0 - predicted / total) + 1.0 - memory * memory
        if abs(later - predicted) <= STEADY * predicted:
            scale[i:], gain[i:] = scale[i], gain[i]
            return scale, gain, log_determinant + (samples - i) * np.log(total)
        log_determinant += np.log(total)
        predicted = later
    return scale, gain, log_determinant


@kernel()
def whiten(rows: FloatArray, memory: float, scale: FloatArray, gain: FloatArray) -> FloatArray:
    """Return (L⁻¹·rows)ᵀ, shape (k, n), transposed for products along time."""
    n, width = rows.shape
    white = np.empty((width, n))
    state = np.zeros(width)
    for i in range(n):
        for j in range(width):
            innovation = rows[i, j] - state[j]
            white[j, i] = innovation * scale[i]
            state[j] = memory * state[j] + gain[i] * innovation
    return white


@kernel()
def whiten_adjoint(rows: FloatArray, memory: float, scale: FloatArray, gain: FloatArray) -> FloatArray:
    """Return L⁻ᵀ·rows, shape (n, k), by the recursion of ``whiten`` run backwards."""
    n, width = rows.shape
    result = np.empty((n, width))
    carried = np.zeros(width)
    for i in range(n - 1, -1, -1):
        for j in range(width):
            own = scale[i] * rows[i, j]
            result[i, j] = own + gain[i] * carried[j]
            carried[j] = (memory - gain[i]) * carried[j] - own
    return result
