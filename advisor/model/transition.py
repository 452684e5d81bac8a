"""Exact discretisation of ẋ = A·x + u + v·t over one step, and its derivatives by A.

The solution is x(h) = φ₀(hA)·x + h·φ₁(hA)·u + h²·φ₂(hA)·v with φₖ(X) = Σ Xⁿ/(n+k)!. By the theorem of Cayley
and Hamilton every power of a 2×2 matrix is p·I + r·X. Each φₖ is therefore two scalars that depend on T = tr
X and D = det X only, and so are its derivatives. The series for the highest order runs on scalars, to
round-off. The others follow from φₖ = I/k! + X·φₖ₊₁. φ₃ gives the integral of the pitch rate, which is the
pitch angle.
"""

import math

from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

ORDERS = 4
"""Number of functions φ₀ to φ₃."""
WIDTH = 13 * ORDERS
"""Length of a row of the table: for each k, three 2×2 matrices and one scalar."""
REACH = 2.0
"""Largest |hA| of one power series; longer steps are divided."""
MOST_DIVISIONS = 256


@kernel()
def divisions(a11: float, a12: float, a21: float, a22: float, h: float) -> int:
    """Return the number of equal parts of a step for fast convergence; 0 if A is too large."""
    trace = abs(a11 + a22)
    determinant = abs(a11 * a22 - a12 * a21)
    size = h * (trace + math.sqrt(determinant))
    if not size < REACH * MOST_DIVISIONS:
        return 0
    return max(1, math.ceil(size / REACH))


@kernel()
def fill(row: FloatArray, a11: float, a12: float, a21: float, a22: float, h: float) -> None:
    """Write the step of length ``h`` into ``row``, shape (``WIDTH``,).

    For each k the row holds four parts, beginning at 13·k. They are Φ = hᵏφₖ (4 numbers, row by row), its
    derivative P by the trace of A (4), its derivative Q by the determinant of A (4), and the factor w of the
    explicit A (1). Then dΦ = P·d(tr A) + Q·d(det A) + w·dA.
    """
    x11, x12, x21, x22 = h * a11, h * a12, h * a21, h * a22
    trace = x11 + x22
    determinant = x11 * x22 - x12 * x21
    size = abs(trace) + math.sqrt(abs(determinant))
    # φ₃ = p·I + r·X, the sum of Xⁿ/(n + 3)! with Xⁿ = a·I + b·X; and their derivatives by T and by D.
    a, b, a_t, b_t, a_d, b_d = 1.0, 0.0, 0.0, 0.0, 0.0, 0.0
    p, r, p_t, r_t, p_d, r_d = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    factor = 1.0 / 6.0
    power = 1.0
    n = 0
    while True:
        p += factor * a
        r += factor * b
        p_t += factor * a_t
        r_t += factor * b_t
        p_d += factor * a_d
        r_d += factor * b_d
        n += 1
        power *= size / n
        if n > 4 and power * n * n < 1e-18:
            break
        a_t, b_t = -determinant * b_t, b + trace * b_t + a_t
        a_d, b_d = -b - determinant * b_d, trace * b_d + a_d
        a, b = -determinant * b, trace * b + a
        factor /= n + 3
    constant = 0.5
    for k in range(ORDERS - 1, -1, -1):
        j = 13 * k
        unit = h**k
        row[j], row[j + 1] = unit * (p + r * x11), unit * r * x12
        row[j + 2], row[j + 3] = unit * r * x21, unit * (p + r * x22)
        unit *= h
        row[j + 4], row[j + 5] = unit * (p_t + r_t * x11), unit * r_t * x12
        row[j + 6], row[j + 7] = unit * r_t * x21, unit * (p_t + r_t * x22)
        row[j + 12] = unit * r
        unit *= h
        row[j + 8], row[j + 9] = unit * (p_d + r_d * x11), unit * r_d * x12
        row[j + 10], row[j + 11] = unit * r_d * x21, unit * (p_d + r_d * x22)
        p_t, r_t = -determinant * r_t, r + trace * r_t + p_t
        p_d, r_d = -r - determinant * r_d, trace * r_d + p_d
        p, r = constant - determinant * r, trace * r + p
        constant = 1.0
