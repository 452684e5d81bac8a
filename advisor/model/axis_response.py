"""The model of any axis solved on the union of all stamps, with exact sensitivities.

Over each step the states are a series (``axis_step``). The inputs are linear (or held) between their stamps.
Speed, attitude and angle of attack are constant over a step. The short period has a separate closed form
(``response``).
"""

from typing import NamedTuple

import numpy as np

from advisor.model.axis_step import TERMS, bend, carry, unfold
from advisor.model.response import Index
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

LARGEST = 1e9
"""Sum of the states' magnitudes above which the model has diverged."""
WIDE = 16
"""Numerical: multiple of the length of the sensitivities' rows, which fills the processor's vectors."""


class AxisGrid(NamedTuple):
    """All manoeuvres of a problem on the union of their stamps, one after another.

    E events, n states, u inputs, C outputs, d derivatives and constants. Columns are those of z: the states,
    the inputs, 1, the sine of the state ``bank``, and the state ``yaw`` times the cosine of ``bank``.
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
    known: FloatArray
    """(E, f) known factors, on the step or at the event; the first is 1."""
    factor: FloatArray
    """(E, d) further factor of each derivative and constant on the step; (0, d) for none."""
    forced: FloatArray
    """(E, n) further known part of the rates on the step, which the outputs see too; (0, n) for none."""
    turning: Index
    """(a, 5) row, column, known factor, open number and sign of each known term of the rates. A term with an
    open number (-1: none) is the derivative of the rates by that number."""
    seen: Index
    """(b, 5) output, state, known factor, open number and sign of each term of the outputs. State n + i is
    the parameters' part of the rate of state i."""
    scale: FloatArray
    """(C,) factor on each output without its bias."""
    row: Index
    """(C, E) row of the measurement of each output at the event, -1 for none."""
    place: Index
    """(d, 3) row, column and power of each derivative and constant."""
    bias: Index
    """(C,) index of each output's bias among all parameters, -1 without one."""
    initial: tuple[int, ...]
    """(n,) index of each state's first value among all parameters. The compiler knows a tuple's length."""
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
    g : (N, s + l + o + k) receives their derivatives by the parameters of the row's manoeuvre, then by the o
        open numbers and by the k causes; with shape (0, s + l + o + k) only the outputs are computed.
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
    place, step_s, initial, bank, yaw = grid.place, grid.step_s, grid.initial, grid.bank, grid.yaw
    ratio, known, turning, seen, scale = grid.ratio, grid.known, grid.turning, grid.seen, grid.scale
    inputs, start, slope, row, bias = grid.inputs, grid.start, grid.slope, grid.row, grid.bias
    changed, changed_start, changed_slope = grid.changed, grid.changed_start, grid.changed_slope
    n, u, begin, end = len(initial), start.shape[1], grid.first[m], grid.first[m + 1]
    powers, matrix, whole = np.empty(len(place)), np.empty((n, n + u + 1)), np.empty((n, n + u + 3))
    z, circle = np.zeros((TERMS, n + u + 3)), np.zeros((TERMS, 2))
    # Rows of full vectors: the processor takes the rest of a row number by number.
    wide = -(-g.shape[1] // WIDE) * WIDE
    by, terms = np.zeros((n, wide)), np.empty((2, n, wide))
    z[0, n + u] = 1.0
    for i in range(n):
        z[0, i] = theta[initial[i]]
        by[i, initial[i]] = 1.0
    for e in range(begin, end):
        if e == begin or _changes(ratio, grid.forced, grid.factor, e):
            _fill(place, ratio[e], grid.factor, e, theta, powers, matrix)
            _force(grid.forced, e, matrix)
        for j in range(u):
            z[0, n + j] = inputs[e, j]
        _begin(row, bias, e, theta, y, g)
        for k in range(len(seen)):
            r, factor = row[seen[k, 0], e], scale[seen[k, 0]] * known[e, seen[k, 2]]
            if r >= 0 and factor != 0.0:
                _read(factor, seen, k, initial, place, changed, e, powers, matrix, z, by, r, y, g)
        h = step_s[e]
        for j in range(u):
            z[0, n + j], z[1, n + j] = start[e, j], h * slope[e, j]
        _know(turning, known, e, matrix, whole)
        order = unfold(h, initial, whole, bank, yaw, z, circle)
        if order == 0:
            return False
        if len(motion) > 0:
            for i in range(n):
                motion[e, 0, i], motion[e, 1, i] = z[0, i], z[1, i] / h
        if len(g) > 0:
            bend(order, bank, yaw, z, whole)
            carry(
                h, order, initial, whole, matrix, place, powers, turning, known, z, changed_start,
                changed_slope, e, g.shape[1] - changed.shape[1], by, terms,
            )  # fmt: skip
        size = 0.0
        for i in range(n):
            for k in range(1, order + 1):
                z[0, i] += z[k, i]
            size += abs(z[0, i])
        if not size < LARGEST:
            return False
    return True


@kernel()
def _fill(
    place: Index, ratio: float, factor: FloatArray, e: int, theta: FloatArray, powers: FloatArray,
    matrix: FloatArray,
) -> None:  # fmt: skip
    """Write the parameters' factors (d,) at an air speed ratio, and the matrix (n, n + u + 1) of the
    parameters."""
    matrix[:] = 0.0
    for k in range(len(place)):
        powers[k] = 1.0
        for _ in range(place[k, 2]):
            powers[k] *= ratio
        if len(factor) > 0:
            powers[k] *= factor[e, k]
        matrix[place[k, 0], place[k, 1]] += theta[k] * powers[k]


@kernel()
def _changes(ratio: FloatArray, forced: FloatArray, factor: FloatArray, e: int) -> bool:
    """Return whether the matrix of the parameters differs from that of the event before."""
    differs: bool = ratio[e] != ratio[e - 1] or len(forced) > 0 or len(factor) > 0
    return differs


@kernel()
def _force(forced: FloatArray, e: int, matrix: FloatArray) -> None:
    """Add the further known part of the rates (E, n) to the constants of the matrix."""
    if len(forced) > 0:
        for i in range(len(matrix)):
            matrix[i, -1] += forced[e, i]


@kernel()
def _know(turning: Index, known: FloatArray, e: int, matrix: FloatArray, whole: FloatArray) -> None:
    """Write the matrix (n, n + u + 3) of the rates: that of the parameters, and the known terms."""
    for i in range(len(whole)):
        for j in range(matrix.shape[1]):
            whole[i, j] = matrix[i, j]
        for j in range(matrix.shape[1], whole.shape[1]):
            whole[i, j] = 0.0
    for k in range(len(turning)):
        if turning[k, 3] < 0:
            whole[turning[k, 0], turning[k, 1]] += known[e, turning[k, 2]]


@kernel()
def _begin(row: Index, bias: Index, e: int, theta: FloatArray, y: FloatArray, g: FloatArray) -> None:
    """Write the biases of the outputs at an event, and their derivatives."""
    for c in range(len(row)):
        r = row[c, e]
        if r >= 0:
            y[r] = theta[bias[c]] if bias[c] >= 0 else 0.0
            if len(g) > 0:
                for k in range(g.shape[1]):
                    g[r, k] = 0.0
                if bias[c] >= 0:
                    g[r, bias[c]] = 1.0


@kernel()
def _read(
    factor: float, seen: Index, term: int, initial: tuple[int, ...], place: Index, changed: FloatArray,
    e: int, powers: FloatArray, matrix: FloatArray, z: FloatArray, by: FloatArray, r: int, y: FloatArray,
    g: FloatArray,
) -> None:  # fmt: skip
    """Add a term of the outputs, a state or the parameters' part of a rate, to output row ``r``.

    With an open number the term is a derivative by that number, and no part of the output.
    """
    i, number = seen[term, 1], seen[term, 3]
    n, width, causes = len(initial), g.shape[1], changed.shape[1]
    part = z[0, i] if i < n else 0.0
    if i >= n:
        for j in range(matrix.shape[1]):
            part += matrix[i - n, j] * z[0, j]
    if number < 0:
        y[r] += factor * part
    if len(g) == 0:
        return
    if number >= 0:
        g[r, number] += seen[term, 4] * factor * part
        return
    if i < n:
        for k in range(width):
            g[r, k] += factor * by[i, k]
        return
    i -= n
    for j in range(n):
        for k in range(width):
            g[r, k] += factor * matrix[i, j] * by[j, k]
    for k in range(len(place)):
        if place[k, 0] == i:
            g[r, k] += factor * powers[k] * z[0, place[k, 1]]
    for k in range(causes):
        for j in range(changed.shape[2]):
            g[r, width - causes + k] += factor * matrix[i, n + j] * changed[e, k, j]
