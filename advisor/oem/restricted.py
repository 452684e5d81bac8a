"""Compiled restricted likelihood of residuals with coloured noise, and the search for its optimum (see
``colour``).

Slopes and curvatures of the search are finite differences, so that a Newton step takes six values. A simplex
takes some thirty values more for the same digits.
"""

import math

import numpy as np

from advisor.model.response import Index
from advisor.oem.whitening import schedule, whiten
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

LARGEST_MEMORY = 0.9995
SMALLEST_SHARE = 1e-4
LOG_SMALLEST_SHARE = math.log(SMALLEST_SHARE)
LOG_LARGEST_SHARE = 9.0
DIFFERENCE = 0.01
"""Numerical: step of the finite differences."""
SETTLED = 1e-4
"""Promised decrease of -2 log likelihood below which a step is the last one. A decrease of this size moves no
parameter by more than a hundredth of its standard deviation."""
_LARGEST_STEP, _FLATTEST = (1.0, 3.0), 1e-3
_MOST_STEPS, _HALVINGS = 30, 6


@kernel()
def restricted(flat: FloatArray, sizes: Index, memory: float, share: float) -> tuple[float, float]:
    """Return the residual power after whitening and regression, and log det Γ + log det XᵀΓ⁻¹X.

    Γ belongs to an x of unit variance.

    Parameters
    ----------
    flat : block (n, p + 1) of regressors and residual of each manoeuvre, one after another.
    sizes : (m, 2) shapes of the blocks.
    """
    power, determinants, first = 0.0, 0.0, 0
    for m in range(len(sizes)):
        n, width = sizes[m, 0], sizes[m, 1]
        block = flat[first : first + n * width].reshape((n, width))
        scale, gain, determinant = schedule(n, memory, share)
        gram = _gram(whiten(block, memory, scale, gain))
        left, own = _eliminated(gram)
        power += left
        determinants += determinant + own
        first += n * width
    return power, determinants


@kernel(fastmath={"reassoc", "contract"})
def _gram(white: FloatArray) -> FloatArray:
    """Return the inner products (k, k) of the rows (k, n), two by two rows at a time."""
    width, n = white.shape
    gram = np.empty((width, width))
    for i in range(0, width, 2):
        i1 = min(i + 1, width - 1)
        for j in range(0, i + 1, 2):
            j1 = min(j + 1, width - 1)
            first, across, back, last = 0.0, 0.0, 0.0, 0.0
            for k in range(n):
                first += white[i, k] * white[j, k]
                across += white[i, k] * white[j1, k]
                back += white[i1, k] * white[j, k]
                last += white[i1, k] * white[j1, k]
            gram[i1, j1], gram[i1, j], gram[i, j1], gram[i, j] = last, back, across, first
    return gram


@kernel()
def _eliminated(gram: FloatArray) -> tuple[float, float]:
    """Return the last diagonal element after elimination of the others, and the log determinant of these."""
    width, determinant = len(gram), 0.0
    for j in range(width - 1):
        for k in range(j):
            gram[j, j] -= gram[j, k] ** 2
        gram[j, j] = math.sqrt(max(gram[j, j], 1e-300))
        determinant += 2.0 * math.log(gram[j, j])
        for i in range(j + 1, width):
            for k in range(j):
                gram[i, j] -= gram[i, k] * gram[j, k]
            gram[i, j] /= gram[j, j]
    left = gram[width - 1, width - 1]
    for k in range(width - 1):
        left -= gram[width - 1, k] ** 2
    return left, determinant


@kernel()
def bounded(first: float, second: float) -> tuple[float, float]:
    """Return memory and white share of a shape on unbounded scales."""
    share = math.exp(min(max(second, LOG_SMALLEST_SHARE), LOG_LARGEST_SHARE))
    return LARGEST_MEMORY * math.tanh(first), share


@kernel()
def likeliest(
    flat: FloatArray, sizes: Index, freedom: int, floor: float, first: float, second: float
) -> tuple[float, float, float]:
    """Return the shape on unbounded scales with a local minimum of -2 log likelihood, and the minimum.

    Parameters
    ----------
    freedom, floor : degrees of freedom, and least residual power.
    first, second : shape at which the search begins.
    """
    lowest = LOG_SMALLEST_SHARE + DIFFERENCE
    second = max(second, lowest)
    data = (flat, sizes, freedom, floor)
    value = _cost(data, first, second)
    for _ in range(_MOST_STEPS):
        ahead, behind = _cost(data, first + DIFFERENCE, second), _cost(data, first - DIFFERENCE, second)
        more, less = _cost(data, first, second + DIFFERENCE), _cost(data, first, second - DIFFERENCE)
        both = _cost(data, first + DIFFERENCE, second + DIFFERENCE)
        slope = (ahead - behind) / (2.0 * DIFFERENCE), (more - less) / (2.0 * DIFFERENCE)
        bends = np.array(
            [ahead + behind - 2.0 * value, both - ahead - more + value, more + less - 2.0 * value]
        )
        held = second <= lowest and slope[1] >= 0.0
        along, across = _step(slope, bends / DIFFERENCE**2, held)
        across = max(across, lowest - second)
        promise = -0.5 * (slope[0] * along + slope[1] * across)
        halvings, there = 0, _cost(data, first + along, second + across)
        while there > value and halvings < _HALVINGS:
            along, across, halvings = 0.5 * along, 0.5 * across, halvings + 1
            there = _cost(data, first + along, second + across)
        if there > value:
            break
        first, second, value = first + along, second + across, there
        if promise < SETTLED:
            break
    if second <= lowest:
        second = LOG_SMALLEST_SHARE
        value = _cost(data, first, second)
    return first, second, value


@kernel()
def _cost(data: tuple[FloatArray, Index, int, float], first: float, second: float) -> float:
    """Return -2 log likelihood of a shape at the likeliest variance."""
    flat, sizes, freedom, floor = data
    memory, share = bounded(first, second)
    power, determinants = restricted(flat, sizes, memory, share)
    return freedom * math.log(max(power, floor) / freedom) + determinants


@kernel()
def _step(slope: tuple[float, float], bends: FloatArray, held: bool) -> tuple[float, float]:
    """Return Newton's step downhill, no longer than the largest step, from slope and curvatures (3,)."""
    a, b, c = bends
    if held:
        along, across = -slope[0] / max(abs(a), _FLATTEST), 0.0
    else:
        mean, apart = 0.5 * (a + c), math.hypot(0.5 * (a - c), b)
        angle = 0.5 * math.atan2(2.0 * b, a - c)
        up, side = math.cos(angle), math.sin(angle)
        large = -(up * slope[0] + side * slope[1]) / max(abs(mean + apart), _FLATTEST)
        small = -(up * slope[1] - side * slope[0]) / max(abs(mean - apart), _FLATTEST)
        along, across = up * large - side * small, side * large + up * small
    most = max(1.0, abs(along) / _LARGEST_STEP[0], abs(across) / _LARGEST_STEP[1])
    return along / most, across / most
