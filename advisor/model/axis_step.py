"""One step of any axis: Taylor series of the states and of their sensitivities.

The order of the series grows with the step, so that every step has the same relative error. The series of the
sensitivities takes the derivatives of the sine and of the cosine in the middle of the step.
"""

import math

from advisor.model.response import Index
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

TOLERANCE = 4e-5
"""Largest relative error of the mean rates over a step: 1e-5 of the states at a quarter of the row sum's
inverse."""
LONGEST = 4.0
"""Largest product of a step and the largest row sum of the matrix, plus the change of bank: rates of 200 1/s
at 50 Hz. A search that reaches faster modes has diverged."""
TERMS = 20
"""Number of terms of a series, more than ``LONGEST`` needs."""


@kernel()
def unfold(
    h: float,
    initial: tuple[int, ...],
    whole: FloatArray,
    bank: int,
    yaw: int,
    z: FloatArray,
    circle: FloatArray,
) -> int:
    """Write the terms of the series of z over a step of length ``h``; return its order, 0 if it is too long.

    Parameters
    ----------
    whole : (n, n + u + 3) matrix of the rates.
    z : (TERMS, n + u + 3) with the inputs and the first states.
    circle : (TERMS, 2) receives the series of the sine and the cosine.
    """
    n, size = len(initial), whole.shape[1]
    m, left, reach = 0, 1.0, 0.0
    while left > TOLERANCE:
        if bank >= 0:
            _turn(m, bank, yaw, z, circle)
        factor = h / (m + 1)
        for i in range(n):
            value = 0.0
            for j in range(size):
                value += whole[i, j] * z[m, j]
            z[m + 1, i] = factor * value
        m += 1
        if m == 1:
            reach = h * _largest(initial, whole) + (abs(z[1, bank]) if bank >= 0 else 0.0)
            if not reach < LONGEST:
                return 0
        left *= reach / (m + 1)
    return m


@kernel()
def _largest(initial: tuple[int, ...], whole: FloatArray) -> float:
    """Return the largest row sum of the matrix of the states."""
    largest = 0.0
    for i in range(len(initial)):
        total = 0.0
        for j in range(len(initial)):
            total += abs(whole[i, j])
        largest = max(largest, total)
    return largest


@kernel()
def _turn(m: int, bank: int, yaw: int, z: FloatArray, circle: FloatArray) -> None:
    """Write the terms of order ``m`` of the sine, and of the yaw rate times the cosine."""
    last = z.shape[1] - 1
    if m == 0:
        circle[0, 0], circle[0, 1] = math.sin(z[0, bank]), math.cos(z[0, bank])
    else:
        up, along = 0.0, 0.0
        for k in range(1, m + 1):
            up += k * z[k, bank] * circle[m - k, 1]
            along -= k * z[k, bank] * circle[m - k, 0]
        circle[m, 0], circle[m, 1] = up / m, along / m
    value = 0.0
    for k in range(m + 1):
        value += z[k, yaw] * circle[m - k, 1]
    z[m, last - 1], z[m, last] = circle[m, 0], value


@kernel()
def bend(order: int, bank: int, yaw: int, z: FloatArray, whole: FloatArray) -> None:
    """Add the derivatives of sine and cosine in the middle of a step to the matrix of the rates."""
    if bank < 0:
        return
    last = z.shape[1] - 1
    angle, rate, share = 0.0, 0.0, 1.0
    for m in range(order + 1):
        angle += share * z[m, bank]
        rate += share * z[m, yaw]
        share *= 0.5
    up, along = math.sin(angle), math.cos(angle)
    for i in range(len(whole)):
        whole[i, bank] += whole[i, last - 1] * along - whole[i, last] * rate * up
        whole[i, yaw] += whole[i, last] * along


@kernel()
def carry(
    h: float, order: int, initial: tuple[int, ...], whole: FloatArray, matrix: FloatArray, place: Index,
    powers: FloatArray, turning: Index, known: FloatArray, z: FloatArray, changed_start: FloatArray,
    changed_slope: FloatArray, e: int, first: int, by: FloatArray, terms: FloatArray,
) -> None:  # fmt: skip
    """Advance the sensitivities ``by`` (n, w) of the states over one step. The causes begin at ``first``."""
    n, width, causes, inputs = len(initial), by.shape[1], changed_start.shape[1], changed_start.shape[2]
    for i in range(n):
        for k in range(width):
            terms[0, i, k] = by[i, k]
    for m in range(order):
        now, then, factor = m % 2, 1 - m % 2, h / (m + 1)
        for i in range(n):
            for k in range(width):
                value = 0.0
                for j in range(n):
                    value += whole[i, j] * terms[now, j, k]
                terms[then, i, k] = factor * value
        for k in range(len(place)):
            terms[then, place[k, 0], k] += factor * powers[k] * z[m, place[k, 1]]
        _open(factor, turning, known, z, e, m, terms, then)
        if m < 2:
            for k in range(causes):
                for j in range(inputs):
                    move = factor * (changed_start[e, k, j] if m == 0 else h * changed_slope[e, k, j])
                    for i in range(n):
                        terms[then, i, first + k] += move * matrix[i, n + j]
        for i in range(n):
            for k in range(width):
                by[i, k] += terms[then, i, k]


@kernel()
def _open(
    factor: float, turning: Index, known: FloatArray, z: FloatArray, e: int, m: int, terms: FloatArray,
    then: int,
) -> None:  # fmt: skip
    """Add ``factor`` times the derivatives of the rates by open numbers, of order ``m``."""
    for k in range(len(turning)):
        if turning[k, 3] >= 0:
            rate = turning[k, 4] * known[e, turning[k, 2]] * z[m, turning[k, 1]]
            terms[then, turning[k, 0], turning[k, 3]] += factor * rate
