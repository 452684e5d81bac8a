"""Exact discretisation of ẋ = A·x + u + v·t over one step, and its derivatives by A.

The solution is x(h) = φ₀(hA)·x + h·φ₁(hA)·u + h²·φ₂(hA)·v with φₖ(X) = Σ Xⁿ/(n+k)!. By the
theorem of Cayley and Hamilton every power of a 2×2 matrix is p·I + r·X, so that each φₖ is two
scalars that depend on T = tr X and D = det X only, and so are their derivatives: the series
below runs on scalars, to round-off. φ₃ serves the integral of the pitch rate, which is the
pitch angle.
"""

import math

import numba
import numpy as np

from advisor.flight.messages import FloatArray

ORDERS = 4
"""φ₀ to φ₃."""
WIDTH = 13 * ORDERS
"""Numbers in a row of the table: for each k, three 2×2 matrices and one scalar."""
REACH = 2.0
"""Largest |hA| of one series; longer steps are divided."""
MOST_DIVISIONS = 256


@numba.njit(cache=True)
def divisions(a11: float, a12: float, a21: float, a22: float, h: float) -> int:
    """Equal parts a step is cut into so that the series converges fast; 0 when A is beyond use."""
    trace = abs(a11 + a22)
    determinant = abs(a11 * a22 - a12 * a21)
    size = h * (trace + math.sqrt(determinant))
    if not size < REACH * MOST_DIVISIONS:
        return 0
    return max(1, math.ceil(size / REACH))


@numba.njit(cache=True)
def fill(row: FloatArray, a11: float, a12: float, a21: float, a22: float, h: float) -> None:
    """Write the step of length ``h`` into ``row``, shape (``WIDTH``,).

    For each k the row holds, at 13·k: Φ = hᵏφₖ (4 numbers, row by row), its derivative by the
    trace of A (4), by the determinant of A (4), and the factor of the explicit A (1), so that
    dΦ = P·d(tr A) + Q·d(det A) + w·dA.
    """
    x11, x12, x21, x22 = h * a11, h * a12, h * a21, h * a22
    trace = x11 + x22
    determinant = x11 * x22 - x12 * x21
    size = abs(trace) + math.sqrt(abs(determinant))
    scale = np.ones(ORDERS)
    for k in range(1, ORDERS):
        scale[k] = scale[k - 1] / k
    # Xⁿ = p·I + r·X, and the derivatives of p and r by T and by D; n = 0 to begin with.
    p, r = 1.0, 0.0
    p_t, r_t = 0.0, 0.0
    p_d, r_d = 0.0, 0.0
    sums = np.zeros((ORDERS, 6))
    power = 1.0
    n = 0
    while True:
        for k in range(ORDERS):
            sums[k, 0] += scale[k] * p
            sums[k, 1] += scale[k] * r
            sums[k, 2] += scale[k] * p_t
            sums[k, 3] += scale[k] * r_t
            sums[k, 4] += scale[k] * p_d
            sums[k, 5] += scale[k] * r_d
        n += 1
        power *= size / n
        if n > 4 and power * n * n < 1e-18:
            break
        p_t, r_t = -determinant * r_t, r + trace * r_t + p_t
        p_d, r_d = -r - determinant * r_d, trace * r_d + p_d
        p, r = -determinant * r, trace * r + p
        for k in range(ORDERS):
            scale[k] /= n + k
    unit = 1.0
    for k in range(ORDERS):
        j = 13 * k
        for i in range(3):
            factor = unit * h**i
            diagonal, along = factor * sums[k, 2 * i], factor * sums[k, 2 * i + 1]
            row[j + 4 * i] = diagonal + along * x11
            row[j + 4 * i + 1] = along * x12
            row[j + 4 * i + 2] = along * x21
            row[j + 4 * i + 3] = diagonal + along * x22
        row[j + 12] = unit * h * sums[k, 1]
        unit *= h
