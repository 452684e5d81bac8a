"""The model of any axis solved on the union of all stamps, with exact sensitivities.

The classical Runge-Kutta method solves the states. The sensitivities are carried with the exponential of the
matrix in the middle of each step, and Simpson's rule for their forcing. Both are of fourth order. The inputs
are linear (or held) between their stamps. Speed, attitude and angle of attack are constant over a step. The
short period has a closed form of its own (``response``).
"""

import math
from typing import NamedTuple

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.response import Index
from advisor.process.compiled import kernel

REACH = 0.25
"""Largest product of a step and the largest row sum of the matrix. The error of a step is below 1e-5 of the
states."""
MOST_PARTS = 16
"""Most parts of a step: rates of 200 1/s at 50 Hz. A search that asks for faster ones has gone astray."""
LARGEST = 1e9
"""Sum of the states' sizes at which the model has run away."""


class AxisGrid(NamedTuple):
    """All manoeuvres of a problem on the union of their stamps, one after another.

    E events, n states, u inputs, C outputs, k derivatives and constants.
    """

    first: Index
    """(m + 1,) index of the first event of each manoeuvre, and E."""
    step_s: FloatArray
    """(E,) length of the step to the next event."""
    ratio: FloatArray
    """(E,) air speed ratio s on the step; at a manoeuvre's last event, of the step to that event."""
    inputs: FloatArray
    """(E, u) inputs at the event."""
    start: FloatArray
    """(E, u) inputs just after the event."""
    slope: FloatArray
    """(E, u) rates of the inputs on the step."""
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
    """(k, 3) row, column and power of each derivative and constant."""
    bias: Index
    """(C,) index of each output's bias among all parameters, -1 without one."""
    bank: int
    """State whose sine and cosine enter; -1 for none."""
    yaw: int
    """State that the cosine multiplies."""


@kernel()
def respond_axis(grid: AxisGrid, shared: FloatArray, local: FloatArray, y: FloatArray, g: FloatArray) -> bool:
    """Solve the model and write outputs and sensitivities.

    Parameters
    ----------
    shared : (s,) derivatives.
    local : (m, l) constants, initial states and biases of each manoeuvre.
    y : (N,), which receives the outputs.
    g : (N, s + l) receives their derivatives by the parameters of the row's manoeuvre; with
        shape (0, s + l) only the outputs are computed.

    Returns
    -------
    False where the parameters make the model overflow; ``y`` and ``g`` are then useless.
    """
    theta = np.empty(len(shared) + local.shape[1])
    theta[: len(shared)] = shared
    for m in range(len(grid.first) - 1):
        theta[len(shared) :] = local[m]
        if not _respond_in(grid, m, theta, y, g):
            return False
    return True


@kernel()
def _respond_in(grid: AxisGrid, m: int, theta: FloatArray, y: FloatArray, g: FloatArray) -> bool:
    """Solve the model over manoeuvre ``m`` with ``theta``, all parameters; return False where it
    overflows."""
    n, known = grid.linear.shape[1], len(grid.place)
    width = known + n if g.shape[0] > 0 else 0
    x = theta[known : known + n].copy()
    by, moved = np.zeros((n, width)), np.zeros((n, width))
    for i in range(n if width else 0):
        by[i, known + i] = 1.0
    z = np.empty(n + grid.inputs.shape[1] + 1)
    matrix = np.zeros((n, len(z)))
    begin, end = grid.first[m], grid.first[m + 1]
    for e in range(begin, end):
        _fill(grid, grid.ratio[e], theta, matrix)
        _read(grid, e, theta, x, by, matrix, z, y, g)
        if e + 1 == end:
            break
        parts = _parts(grid.linear[e], matrix, grid.step_s[e])
        if parts == 0:
            return False
        h = grid.step_s[e] / parts
        for part in range(parts):
            x, before, middle, after, jacobian = _advance(grid, e, part * h, h, matrix, x)
            if width:
                _carry(grid, e, h, jacobian, before, middle, after, by, moved)
        if not np.sum(np.abs(x)) < LARGEST:
            return False
    return True


@kernel()
def _advance(
    grid: AxisGrid, e: int, since_s: float, h: float, matrix: FloatArray, x: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray, FloatArray]:
    """Advance the states ``x`` (n,) by a step of length ``h`` that begins ``since_s`` after event ``e``.

    Returns
    -------
    The new states (n,); states, inputs and 1 at the beginning, in the middle and at the end of the step, each
    (n + u + 1,); and the derivatives (n, n) of the rates by the states in the middle.
    """
    n = len(x)
    width = n + grid.inputs.shape[1] + 1
    before, middle, after = np.empty(width), np.empty(width), np.empty(width)
    jacobian, rate, total = np.empty((n, n)), np.empty(n), np.zeros(n)
    _feature(grid, e, x, since_s, before)
    _rates(grid, e, matrix, before, rate, jacobian)
    total += rate
    for _ in range(2):
        _feature(grid, e, x + 0.5 * h * rate, since_s + 0.5 * h, middle)
        _rates(grid, e, matrix, middle, rate, jacobian)
        total += 2.0 * rate
    in_the_middle = jacobian.copy()
    _feature(grid, e, x + h * rate, since_s + h, after)
    _rates(grid, e, matrix, after, rate, jacobian)
    total += rate
    moved = x + h / 6.0 * total
    after[:n] = moved
    return moved, before, middle, after, in_the_middle


@kernel()
def _carry(
    grid: AxisGrid,
    e: int,
    h: float,
    jacobian: FloatArray,
    before: FloatArray,
    middle: FloatArray,
    after: FloatArray,
    by: FloatArray,
    moved: FloatArray,
) -> None:
    """Advance the sensitivities ``by`` (n, w) over a step, by Simpson's rule for the forcing.

    The derivatives of the rates are those in the middle. ``moved`` (n, w) is overwritten.
    """
    n, width = by.shape
    whole, half = _exponential(h * jacobian), _exponential(0.5 * h * jacobian)
    for i in range(n):
        for k in range(width):
            moved[i, k] = 0.0
        for j in range(n):
            for k in range(width):
                moved[i, k] += whole[i, j] * by[j, k]
    s = grid.ratio[e]
    for k in range(len(grid.place)):
        row, column = grid.place[k, 0], grid.place[k, 1]
        size = h / 6.0 * s ** grid.place[k, 2]
        for i in range(n):
            moved[i, k] += size * (whole[i, row] * before[column] + 4.0 * half[i, row] * middle[column])
        moved[row, k] += size * after[column]
    by[:] = moved


@kernel()
def _exponential(a: FloatArray) -> FloatArray:
    """Return exp(a) of a small matrix (n, n) by its series to the fourth power."""
    n = len(a)
    total, power = np.eye(n), np.eye(n)
    for order in range(1, 5):
        product = np.zeros((n, n))
        for i in range(n):
            for k in range(n):
                for j in range(n):
                    product[i, j] += power[i, k] * a[k, j]
        power = product / order
        total += power
    return total


@kernel()
def _fill(grid: AxisGrid, s: float, theta: FloatArray, matrix: FloatArray) -> None:
    """Write the parameters at an air speed ratio into ``matrix`` (n, n + u + 1)."""
    matrix[:] = 0.0
    for k in range(len(grid.place)):
        matrix[grid.place[k, 0], grid.place[k, 1]] += theta[k] * s ** grid.place[k, 2]


@kernel()
def _parts(linear: FloatArray, matrix: FloatArray, step_s: float) -> int:
    """Return into how many equal parts a step is divided; 0 where the matrix is too large."""
    largest = 0.0
    for i in range(len(linear)):
        size = 0.0
        for j in range(len(linear)):
            size += abs(linear[i, j] + matrix[i, j])
        largest = max(largest, size)
    if not largest * step_s < REACH * MOST_PARTS:
        return 0
    return max(1, math.ceil(largest * step_s / REACH))


@kernel()
def _feature(grid: AxisGrid, e: int, x: FloatArray, since_s: float, z: FloatArray) -> None:
    """Write states, inputs and 1 into ``z``, at a time after event ``e``."""
    n = len(x)
    z[:n] = x
    for j in range(grid.inputs.shape[1]):
        z[n + j] = grid.start[e, j] + since_s * grid.slope[e, j]
    z[len(z) - 1] = 1.0


@kernel()
def _rates(
    grid: AxisGrid, e: int, matrix: FloatArray, z: FloatArray, rate: FloatArray, jacobian: FloatArray
) -> None:
    """Write the rates (n,) of the states, and their derivatives (n, n) by the states."""
    n = len(rate)
    sine, cosine = 0.0, 0.0
    if grid.bank >= 0:
        sine, cosine = math.sin(z[grid.bank]), math.cos(z[grid.bank])
    for i in range(n):
        value = 0.0
        for j in range(len(z)):
            value += matrix[i, j] * z[j]
        for j in range(n):
            value += grid.linear[e, i, j] * z[j]
            jacobian[i, j] = matrix[i, j] + grid.linear[e, i, j]
        if grid.bank >= 0:
            yaw = z[grid.yaw]
            value += grid.sine[e, i] * sine + grid.turn[e, i] * yaw * cosine
            jacobian[i, grid.bank] += grid.sine[e, i] * cosine - grid.turn[e, i] * yaw * sine
            jacobian[i, grid.yaw] += grid.turn[e, i] * cosine
        rate[i] = value


@kernel()
def _read(
    grid: AxisGrid,
    e: int,
    theta: FloatArray,
    x: FloatArray,
    by: FloatArray,
    matrix: FloatArray,
    z: FloatArray,
    y: FloatArray,
    g: FloatArray,
) -> None:
    """Write the outputs at event ``e``, and their derivatives, from states ``x`` with sensitivities
    ``by``."""
    n, width = by.shape
    _feature(grid, e, x, 0.0, z)
    for j in range(grid.inputs.shape[1]):
        z[n + j] = grid.inputs[e, j]
    for c in range(len(grid.row)):
        row = grid.row[c, e]
        if row < 0:
            continue
        bias = grid.bias[c]
        y[row] = theta[bias] if bias >= 0 else 0.0
        if width:
            g[row, :] = 0.0
            if bias >= 0:
                g[row, bias] = 1.0
        for i in range(n):
            factor = grid.seen[e, c, i]
            y[row] += factor * x[i]
            for k in range(width if factor != 0.0 else 0):
                g[row, k] += factor * by[i, k]
            if grid.felt[e, c, i] != 0.0:
                _feel(grid, e, i, grid.felt[e, c, i], by, matrix, z, y[row : row + 1], g[row] if width else z)


@kernel()
def _feel(
    grid: AxisGrid,
    e: int,
    i: int,
    factor: float,
    by: FloatArray,
    matrix: FloatArray,
    z: FloatArray,
    y: FloatArray,
    g: FloatArray,
) -> None:
    """Add the parameters' part of the rate of state ``i`` to an output ``y`` (1,) and to its derivatives
    ``g`` (p,)."""
    n, width = by.shape
    for j in range(len(z)):
        y[0] += factor * matrix[i, j] * z[j]
    if width == 0:
        return
    for j in range(n):
        for k in range(width):
            g[k] += factor * matrix[i, j] * by[j, k]
    s = grid.ratio[e]
    for k in range(len(grid.place)):
        if grid.place[k, 0] == i:
            g[k] += factor * s ** grid.place[k, 2] * z[grid.place[k, 1]]
