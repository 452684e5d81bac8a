"""The model of any axis solved on the union of all stamps, with exact sensitivities.

The classical Runge-Kutta method solves the states. The sensitivities are carried with the exponential of the
matrix in the middle of each step, and Simpson's rule for their forcing. The Runge-Kutta method and the
method for the sensitivities are of fourth order. The inputs are linear (or held) between their stamps.
Speed, attitude and angle of attack are constant over a step. The short period has a closed form of its own
(``response``).
"""

import math
from typing import NamedTuple

import numpy as np

from advisor.model.response import Index
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

REACH = 0.25
"""Largest product of a step and the largest row sum of the matrix. A step then errs by less than 1e-5 of the
states."""
MOST_PARTS = 16
"""Largest number of parts of a step: rates of 200 1/s at 50 Hz. A search that reaches faster modes has
diverged."""
LARGEST = 1e9
"""Sum of the states' magnitudes above which the model has diverged."""


class AxisGrid(NamedTuple):
    """All manoeuvres of a problem on the union of their stamps, one after another.

    E events, n states, u inputs, C outputs, d derivatives and constants.
    """

    first: Index
    """(m + 1,) index of the first event of each manoeuvre, and E."""
    step_s: FloatArray
    """(E,) length of the step to the next event."""
    ratio: FloatArray
    """(E,) air speed ratio s on the step; at a manoeuvre's last event, of the step to that event."""
    inputs: FloatArray
    """(E, u) values of the inputs at the event."""
    start: FloatArray
    """(E, u) values of the inputs just after the event."""
    slope: FloatArray
    """(E, u) rates of the inputs on the step."""
    changed: FloatArray
    """(E, k, u) derivatives of ``inputs`` by k causes, such as a servo's lag."""
    changed_start: FloatArray
    """(E, k, u) derivatives of ``start``."""
    changed_slope: FloatArray
    """(E, k, u) derivatives of ``slope``."""
    linear: FloatArray
    """(E, n, n) known matrix of the states."""
    sine: FloatArray
    """(E, n) known factors of the sine of the state ``bank``."""
    turn: FloatArray
    """(E, n) known factors of the state ``yaw`` times the cosine of the state ``bank``."""
    row: Index
    """(C, E) row of the measurement of each output at the event, -1 for none."""
    seen: FloatArray
    """(E, C, n) factors of the states in each output."""
    felt: FloatArray
    """(E, C, n) factors of the parameters' part of the rates in each output."""
    place: Index
    """(d, 3) row, column and power of each derivative and constant."""
    bias: Index
    """(C,) index of each output's bias among all parameters, -1 without one."""
    bank: int
    """State whose sine and cosine enter; -1 for none."""
    yaw: int
    """State that the cosine multiplies."""


@kernel()
def respond_axis(
    grid: AxisGrid, shared: FloatArray, local: FloatArray, y: FloatArray, g: FloatArray, motion: FloatArray
) -> bool:
    """Solve the model and write outputs, sensitivities and the motion.

    Parameters
    ----------
    shared : (s,) derivatives.
    local : (m, l) constants, initial states and biases of each manoeuvre.
    y : (N,), which receives the outputs.
    g : (N, s + l + k) receives their derivatives by the parameters of the row's manoeuvre, then by the k
        causes; with shape (0, s + l + k) only the outputs are computed.
    motion : (E, 2, n) receives the states and their rates at the events; with shape (0, 2, n) it does not.

    Returns
    -------
    False where the parameters make the model overflow; ``y`` and ``g`` are then useless.
    """
    theta = np.empty(len(shared) + local.shape[1])
    theta[: len(shared)] = shared
    for m in range(len(grid.first) - 1):
        theta[len(shared) :] = local[m]
        if not _respond_in(grid, m, theta, y, g, motion):
            return False
    return True


@kernel()
def _respond_in(
    grid: AxisGrid, m: int, theta: FloatArray, y: FloatArray, g: FloatArray, motion: FloatArray
) -> bool:
    """Solve the model over manoeuvre ``m`` with ``theta``, all parameters; return False if it overflows.

    Each function goes through the whole manoeuvre: to hand the grid over costs as much as a step.
    """
    begin, end = grid.first[m], grid.first[m + 1]
    parts = _parts(grid, begin, end, theta)
    if np.min(parts) == 0:
        return False
    course = np.empty((np.sum(parts), 3, grid.linear.shape[1] + grid.inputs.shape[1] + 1))
    if not _advance(grid, begin, end, theta, parts, course, motion):
        return False
    _read(grid, begin, end, theta, parts, course, y)
    if g.shape[0] > 0:
        _carry(grid, begin, end, theta, parts, course, g)
    return True


@kernel()
def _parts(grid: AxisGrid, begin: int, end: int, theta: FloatArray) -> Index:
    """Return the number of equal parts of each step; 0 if the matrix is too large.

    The last event has a part of no length.
    """
    place, ratio, linear, step_s = grid.place, grid.ratio, grid.linear, grid.step_s
    n = linear.shape[1]
    matrix = np.empty((n, n + grid.inputs.shape[1] + 1))
    parts = np.ones(end - begin, np.int64)
    for e in range(begin, end - 1):
        _fill(place, ratio[e], theta, matrix)
        largest = 0.0
        for i in range(n):
            size = 0.0
            for j in range(n):
                size += abs(linear[e, i, j] + matrix[i, j])
            largest = max(largest, size)
        if not largest * step_s[e] < REACH * MOST_PARTS:
            parts[e - begin] = 0
        else:
            parts[e - begin] = max(1, math.ceil(largest * step_s[e] / REACH))
    return parts


@kernel()
def _fill(place: Index, ratio: float, theta: FloatArray, matrix: FloatArray) -> None:
    """Write the parameters at an air speed ratio into a matrix (n, n + u + 1)."""
    matrix[:] = 0.0
    for k in range(len(place)):
        matrix[place[k, 0], place[k, 1]] += theta[k] * _power(ratio, place[k, 2])


@kernel()
def _power(ratio: float, power: int) -> float:
    """Return the factor of a parameter at an air speed ratio."""
    factor = 1.0
    for _ in range(power):
        factor *= ratio
    return factor


@kernel()
def _advance(
    grid: AxisGrid, begin: int, end: int, theta: FloatArray, parts: Index, course: FloatArray,
    motion: FloatArray,
) -> bool:  # fmt: skip
    """Compute the states over time.

    ``course`` (parts, 3, n + u + 1) receives states, inputs and 1. The three points of a part are its
    beginning, its middle and its end.
    """
    place, ratio, step_s = grid.place, grid.ratio, grid.step_s
    start, slope = grid.start, grid.slope
    linear, sine, turn, bank, yaw = grid.linear, grid.sine, grid.turn, grid.bank, grid.yaw
    n, inputs = linear.shape[1], start.shape[1]
    x, rate, total = theta[len(place) : len(place) + n].copy(), np.zeros(n), np.empty(n)
    matrix = np.empty((n, course.shape[2]))
    k = 0
    for e in range(begin, end):
        _fill(place, ratio[e], theta, matrix)
        h = step_s[e] / parts[e - begin] if e + 1 < end else 0.0
        for part in range(parts[e - begin]):
            total[:] = 0.0
            for stage in range(4):
                row = (stage + 1) // 2
                since = 0.5 * row * h
                for i in range(n):
                    course[k, row, i] = x[i] + since * rate[i]
                for j in range(inputs):
                    course[k, row, n + j] = start[e, j] + (part * h + since) * slope[e, j]
                course[k, row, n + inputs] = 1.0
                _rates(linear, sine, turn, bank, yaw, e, matrix, course, k, row, rate)
                if stage == 0 and part == 0 and motion.shape[0] > 0:
                    motion[e, 0], motion[e, 1] = x, rate
                for i in range(n):
                    total[i] += (2.0 if row == 1 else 1.0) * rate[i]
            size = 0.0
            for i in range(n):
                x[i] += h / 6.0 * total[i]
                course[k, 2, i] = x[i]
                size += abs(x[i])
            if not size < LARGEST:
                return False
            k += 1
    return True


@kernel()
def _rates(
    linear: FloatArray, sine: FloatArray, turn: FloatArray, bank: int, yaw: int, e: int, matrix: FloatArray,
    course: FloatArray, k: int, row: int, rate: FloatArray,
) -> None:  # fmt: skip
    """Write the rates of the states (n,) at one point of part ``k``."""
    n, size = matrix.shape
    up, along = 0.0, 0.0
    if bank >= 0:
        up, along = math.sin(course[k, row, bank]), math.cos(course[k, row, bank]) * course[k, row, yaw]
    for i in range(n):
        value = 0.0
        for j in range(size):
            value += matrix[i, j] * course[k, row, j]
        for j in range(n):
            value += linear[e, i, j] * course[k, row, j]
        if bank >= 0:
            value += sine[e, i] * up + turn[e, i] * along
        rate[i] = value


@kernel()
def _read(
    grid: AxisGrid, begin: int, end: int, theta: FloatArray, parts: Index, course: FloatArray, y: FloatArray
) -> None:
    """Write the outputs of the model at all events."""
    place, ratio, inputs, bias = grid.place, grid.ratio, grid.inputs, grid.bias
    row, seen, felt = grid.row, grid.seen, grid.felt
    n, moved = seen.shape[2], inputs.shape[1]
    matrix = np.empty((n, n + moved + 1))
    k = 0
    for e in range(begin, end):
        _fill(place, ratio[e], theta, matrix)
        for c in range(len(row)):
            if row[c, e] < 0:
                continue
            value = theta[bias[c]] if bias[c] >= 0 else 0.0
            for i in range(n):
                rate = matrix[i, n + moved]
                for j in range(n):
                    rate += matrix[i, j] * course[k, 0, j]
                for j in range(moved):
                    rate += matrix[i, n + j] * inputs[e, j]
                value += seen[e, c, i] * course[k, 0, i] + felt[e, c, i] * rate
            y[row[c, e]] = value
        k += parts[e - begin]


@kernel()
def _carry(
    grid: AxisGrid, begin: int, end: int, theta: FloatArray, parts: Index, course: FloatArray, g: FloatArray
) -> None:
    """Write the sensitivities of the outputs to the parameters.

    Sensitivities of the states are advanced by Simpson's rule for the forcing. The derivatives of the rates
    are those in the middle of each part.
    """
    place, ratio, step_s = grid.place, grid.ratio, grid.step_s
    linear, sine, turn, bank, yaw = grid.linear, grid.sine, grid.turn, grid.bank, grid.yaw
    start, slope, inputs, changed = grid.changed_start, grid.changed_slope, grid.inputs, grid.changed
    row, seen, felt, bias = grid.row, grid.seen, grid.felt, grid.bias
    n = linear.shape[1]
    by = np.zeros((n, len(place) + n + changed.shape[1]))
    for i in range(n):
        by[i, len(place) + i] = 1.0
    moved = np.empty(by.shape)
    matrix = np.empty((n, course.shape[2]))
    a, whole, half, term = np.empty((n, n)), np.empty((n, n)), np.empty((n, n)), np.empty((2, n, n))
    k = 0
    for e in range(begin, end):
        _fill(place, ratio[e], theta, matrix)
        for c in range(len(row)):
            if row[c, e] >= 0:
                _feel(
                    place, ratio[e], inputs, changed, seen, felt, bias, e, c, matrix, course, k, by, g,
                    row[c, e],
                )  # fmt: skip
        h = step_s[e] / parts[e - begin] if e + 1 < end else 0.0
        for part in range(parts[e - begin] if e + 1 < end else 0):
            for i in range(n):
                for j in range(n):
                    a[i, j] = matrix[i, j] + linear[e, i, j]
                if bank >= 0:
                    up, along = math.sin(course[k, 1, bank]), math.cos(course[k, 1, bank])
                    a[i, bank] += sine[e, i] * along - turn[e, i] * course[k, 1, yaw] * up
                    a[i, yaw] += turn[e, i] * along
            _exponential(h, a, whole, term)
            _exponential(0.5 * h, a, half, term)
            _force(place, ratio[e], start, slope, e, part * h, h, matrix, course, k, whole, half, by, moved)
            k += 1


@kernel()
def _force(
    place: Index, ratio: float, changed_start: FloatArray, changed_slope: FloatArray, e: int,
    since_s: float, h: float, matrix: FloatArray, course: FloatArray, part: int, whole: FloatArray,
    half: FloatArray, by: FloatArray, moved: FloatArray,
) -> None:  # fmt: skip
    """Advance the sensitivities ``by`` (n, w) over one part of a step."""
    n, width = by.shape
    moved[:] = 0.0
    for i in range(n):
        for j in range(n):
            for k in range(width):
                moved[i, k] += whole[i, j] * by[j, k]
    for k in range(len(place)):
        row, column = place[k, 0], place[k, 1]
        size = h / 6.0 * _power(ratio, place[k, 2])
        first, second = size * course[part, 0, column], 4.0 * size * course[part, 1, column]
        for i in range(n):
            moved[i, k] += whole[i, row] * first + half[i, row] * second
        moved[row, k] += size * course[part, 2, column]
    for c in range(changed_start.shape[1]):
        k = len(place) + n + c
        for j in range(changed_start.shape[2]):
            start, slope = changed_start[e, c, j], changed_slope[e, c, j]
            first, last = start + since_s * slope, start + (since_s + h) * slope
            for row in range(n):
                size = h / 6.0 * matrix[row, n + j]
                if size != 0.0:
                    for i in range(n):
                        moved[i, k] += size * (whole[i, row] * first + 2.0 * half[i, row] * (first + last))
                    moved[row, k] += size * last
    by[:] = moved


@kernel()
def _exponential(h: float, a: FloatArray, total: FloatArray, term: FloatArray) -> None:
    """Write exp(h·a) of a small matrix (n, n) into ``total``, by its series to the fourth power."""
    n = len(a)
    for i in range(n):
        for k in range(n):
            term[0, i, k] = h * a[i, k]
            total[i, k] = term[0, i, k] + (1.0 if i == k else 0.0)
    for order in range(2, 5):
        now = order % 2
        for i in range(n):
            for k in range(n):
                product = 0.0
                for j in range(n):
                    product += term[now, i, j] * a[j, k]
                term[1 - now, i, k] = h / order * product
                total[i, k] += term[1 - now, i, k]


@kernel()
def _feel(
    place: Index, ratio: float, inputs: FloatArray, changed: FloatArray, seen: FloatArray, felt: FloatArray,
    bias: Index, e: int, c: int, matrix: FloatArray, course: FloatArray, part: int, by: FloatArray,
    g: FloatArray, row: int,
) -> None:  # fmt: skip
    """Write the derivatives of output ``c`` at event ``e``, at the beginning of a part.

    Columns of biases follow the columns of the initial states; the columns of causes come last.
    """
    n, causes, last = len(by), changed.shape[1], g.shape[1]
    own = len(place) + n
    g[row, :] = 0.0
    if bias[c] >= 0:
        g[row, bias[c]] = 1.0
    for i in range(n):
        for j in range(n):
            factor = felt[e, c, i] * matrix[i, j] + (seen[e, c, i] if i == j else 0.0)
            if factor != 0.0:
                for k in range(own):
                    g[row, k] += factor * by[j, k]
                for k in range(causes):
                    g[row, last - causes + k] += factor * by[j, own + k]
        if felt[e, c, i] == 0.0:
            continue
        for k in range(len(place)):
            if place[k, 0] == i:
                column = place[k, 1]
                z = inputs[e, column - n] if n <= column < n + inputs.shape[1] else course[part, 0, column]
                g[row, k] += felt[e, c, i] * _power(ratio, place[k, 2]) * z
        for k in range(causes):
            for j in range(inputs.shape[1]):
                g[row, last - causes + k] += felt[e, c, i] * matrix[i, n + j] * changed[e, k, j]
