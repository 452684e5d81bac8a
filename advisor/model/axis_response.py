"""The model of any axis solved on the union of all stamps, with exact sensitivities.

The classical Runge-Kutta method solves the states. The sensitivities are carried with the exponential of the
matrix in the middle of each step, and Simpson's rule for their forcing. Both are of fourth order. The inputs
are linear (or held) between their stamps. Speed, attitude and angle of attack are constant over a step. The
short period has a closed form of its own (``response``).
"""

import math
from typing import NamedTuple

import numpy as np

from advisor.model.response import Index
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

REACH = 0.25
"""Largest product of a step and the largest row sum of the matrix. Its error is below 1e-5 of the states."""
MOST_PARTS = 16
"""Most parts of a step: rates of 200 1/s at 50 Hz. A search that asks for faster ones has gone astray."""
LARGEST = 1e9
"""Sum of the states' sizes at which the model has run away."""


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
    """(E, u) inputs at the event."""
    start: FloatArray
    """(E, u) inputs just after the event."""
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


class _Scratch(NamedTuple):
    """Arrays of one step, allocated once: the kernel spends its time on numbers, not on memory."""

    before: FloatArray
    """(n + u + 1,) states, inputs and 1 at the beginning of the step."""
    middle: FloatArray
    """(n + u + 1,) in the middle of the step."""
    after: FloatArray
    """(n + u + 1,) at the end of the step."""
    matrix: FloatArray
    """(n, n + u + 1) parameters at the air speed ratio of the step."""
    power: FloatArray
    """(d,) factor of each derivative and constant by the air speed ratio."""
    rate: FloatArray
    """(n,) rates of the states."""
    total: FloatArray
    """(n,) weighted sum of the rates in the step."""
    trial: FloatArray
    """(n,) states at which the rates are taken."""
    jacobian: FloatArray
    """(n, n) derivatives of the rates by the states."""
    whole: FloatArray
    """(n, n) exponential of the matrix over the step."""
    half: FloatArray
    """(n, n) exponential over half the step."""
    term: FloatArray
    """(2, n, n) terms of the series of an exponential."""
    moved: FloatArray
    """(n, w) new sensitivities."""


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
    """Solve the model over manoeuvre ``m`` with ``theta``, all parameters; return False if it overflows."""
    n, known, inputs = grid.linear.shape[1], len(grid.place), grid.inputs.shape[1]
    width = known + n + grid.changed.shape[1] if g.shape[0] > 0 else 0
    x = theta[known : known + n].copy()
    by = np.zeros((n, width))
    for i in range(n if width else 0):
        by[i, known + i] = 1.0
    size = n + inputs + 1
    scratch = _Scratch(
        np.empty(size), np.empty(size), np.empty(size), np.zeros((n, size)), np.empty(known),
        np.empty(n), np.empty(n), np.empty(n),
        np.empty((n, n)), np.empty((n, n)), np.empty((n, n)), np.empty((2, n, n)), np.empty((n, width)),
    )  # fmt: skip
    begin, end = grid.first[m], grid.first[m + 1]
    for e in range(begin, end):
        if e == begin or grid.ratio[e] != grid.ratio[e - 1]:
            _fill(grid, grid.ratio[e], theta, scratch)
        _read(grid, e, theta, x, by, scratch, y, g)
        if motion.shape[0] > 0:
            _feature(grid, e, x, 0.0, scratch.before)
            _rates(grid, e, scratch.before, scratch)
            motion[e, 0], motion[e, 1] = x, scratch.rate
        if e + 1 == end:
            break
        parts = _parts(grid.linear[e], scratch.matrix, grid.step_s[e])
        if parts == 0:
            return False
        h = grid.step_s[e] / parts
        for part in range(parts):
            _advance(grid, e, part * h, h, x, scratch, width > 0)
            if width:
                _carry(grid, e, part * h, h, by, scratch)
        size_of_states = 0.0
        for i in range(n):
            size_of_states += abs(x[i])
        if not size_of_states < LARGEST:
            return False
    return True


@kernel()
def _advance(
    grid: AxisGrid, e: int, since_s: float, h: float, x: FloatArray, scratch: _Scratch, carries: bool
) -> None:
    """Advance the states ``x`` (n,) by a step of length ``h`` that begins ``since_s`` after event ``e``.

    ``scratch`` receives the states and inputs at three times of the step. Where sensitivities are carried,
    it receives the exponentials of the matrix in the middle, too.
    """
    n = len(x)
    rate, total, trial = scratch.rate, scratch.total, scratch.trial
    _feature(grid, e, x, since_s, scratch.before)
    _rates(grid, e, scratch.before, scratch)
    total[:] = rate
    for _ in range(2):
        for i in range(n):
            trial[i] = x[i] + 0.5 * h * rate[i]
        _feature(grid, e, trial, since_s + 0.5 * h, scratch.middle)
        _rates(grid, e, scratch.middle, scratch)
        for i in range(n):
            total[i] += 2.0 * rate[i]
    if carries:
        _exponential(h, scratch.jacobian, scratch.whole, scratch.term)
        _exponential(0.5 * h, scratch.jacobian, scratch.half, scratch.term)
    for i in range(n):
        trial[i] = x[i] + h * rate[i]
    _feature(grid, e, trial, since_s + h, scratch.after)
    _rates(grid, e, scratch.after, scratch)
    for i in range(n):
        x[i] += h / 6.0 * (total[i] + rate[i])
        scratch.after[i] = x[i]


@kernel()
def _carry(grid: AxisGrid, e: int, since_s: float, h: float, by: FloatArray, scratch: _Scratch) -> None:
    """Advance the sensitivities ``by`` (n, w) over a step, by Simpson's rule for the forcing.

    The derivatives of the rates are those in the middle.
    """
    n, width = by.shape
    whole, half, matrix, moved = scratch.whole, scratch.half, scratch.matrix, scratch.moved
    moved[:] = 0.0
    for i in range(n):
        for j in range(n):
            for k in range(width):
                moved[i, k] += whole[i, j] * by[j, k]
    for k in range(len(grid.place)):
        row, column = grid.place[k, 0], grid.place[k, 1]
        size = h / 6.0 * scratch.power[k]
        first, second = size * scratch.before[column], 4.0 * size * scratch.middle[column]
        for i in range(n):
            moved[i, k] += whole[i, row] * first + half[i, row] * second
        moved[row, k] += size * scratch.after[column]
    for c in range(grid.changed.shape[1]):
        k = len(grid.place) + n + c
        for j in range(grid.inputs.shape[1]):
            start, slope = grid.changed_start[e, c, j], grid.changed_slope[e, c, j]
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
        old, new = term[order % 2], term[1 - order % 2]
        for i in range(n):
            for k in range(n):
                product = 0.0
                for j in range(n):
                    product += old[i, j] * a[j, k]
                new[i, k] = h / order * product
                total[i, k] += new[i, k]


@kernel()
def _fill(grid: AxisGrid, s: float, theta: FloatArray, scratch: _Scratch) -> None:
    """Write the parameters at an air speed ratio, and their factors by the ratio."""
    scratch.matrix[:] = 0.0
    for k in range(len(grid.place)):
        scratch.power[k] = s ** grid.place[k, 2]
        scratch.matrix[grid.place[k, 0], grid.place[k, 1]] += theta[k] * scratch.power[k]


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
    for i in range(n):
        z[i] = x[i]
    for j in range(grid.inputs.shape[1]):
        z[n + j] = grid.start[e, j] + since_s * grid.slope[e, j]
    z[len(z) - 1] = 1.0


@kernel()
def _rates(grid: AxisGrid, e: int, z: FloatArray, scratch: _Scratch) -> None:
    """Write the rates of the states at ``z`` (n + u + 1,), and their derivatives by the states."""
    rate, jacobian, matrix = scratch.rate, scratch.jacobian, scratch.matrix
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
    scratch: _Scratch,
    y: FloatArray,
    g: FloatArray,
) -> None:
    """Write the outputs at event ``e``, and their derivatives, from states ``x``, sensitivities ``by``."""
    n, width = by.shape
    z, own = scratch.before, len(grid.place) + len(x)
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
            if factor != 0.0 and width:
                _add(factor, by[i], own, g[row])
            if grid.felt[e, c, i] != 0.0:
                _feel(grid, e, i, grid.felt[e, c, i], by, scratch, y[row : row + 1], g[row] if width else z)


@kernel()
def _add(factor: float, by: FloatArray, own: int, g: FloatArray) -> None:
    """Add sensitivities ``by`` (w,) of a state to those of an output ``g`` (p,), whose biases have columns
    after the first ``own``."""
    for k in range(own):
        g[k] += factor * by[k]
    for k in range(own, len(by)):
        g[len(g) - len(by) + k] += factor * by[k]


@kernel()
def _feel(
    grid: AxisGrid,
    e: int,
    i: int,
    factor: float,
    by: FloatArray,
    scratch: _Scratch,
    y: FloatArray,
    g: FloatArray,
) -> None:
    """Add the parameters' part of the rate of state ``i`` to an output ``y`` (1,), derivatives ``g`` (p,)."""
    n, width = by.shape
    matrix, z = scratch.matrix, scratch.before
    for j in range(len(z)):
        y[0] += factor * matrix[i, j] * z[j]
    if width == 0:
        return
    for j in range(n):
        if matrix[i, j] != 0.0:
            _add(factor * matrix[i, j], by[j], len(grid.place) + n, g)
    for k in range(len(grid.place)):
        if grid.place[k, 0] == i:
            g[k] += factor * scratch.power[k] * z[grid.place[k, 1]]
    causes = grid.changed.shape[1]
    for c in range(causes):
        for j in range(grid.inputs.shape[1]):
            g[len(g) - causes + c] += factor * matrix[i, n + j] * grid.changed[e, c, j]
