"""Derivatives of the outputs by changes of the input, and by instruments that only read the motion.

The model is linear in its input. From rest, a change of the input moves α, q and θ as the exact solution for
a step does. One pass over the events gives the columns of any number of changes.
"""

from typing import NamedTuple

import numpy as np

from advisor.model.response import Grid, Index, fill_transitions
from advisor.model.short_period_step import advanced, force_slopes, rates
from advisor.model.transition import WIDTH
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

BY_VANE, BY_ACCELEROMETER, BY_ALPHA_DELAY = 0, 1, 2
"""Columns of the sensitivities by the vane's arm, the accelerometer's arm and the delay of α."""
N_READING = 3
"""Number of columns by instruments that read the motion; those by changes of the input follow."""


class InputChange(NamedTuple):
    """Derivative of the elevator deflection by k causes, on a grid of E events."""

    at: FloatArray
    """(E, k) at the event."""
    start: FloatArray
    """(E, k) just after the event."""
    slope: FloatArray
    """(E, k) rate on the step, 1/s."""
    impulse: FloatArray
    """(E, k) integral of a change that is concentrated at the event, s."""


@kernel()
def respond_to_change(
    grid: Grid, shared: FloatArray, local: FloatArray, change: InputChange, columns: FloatArray
) -> bool:
    """Write the derivatives of the outputs by three instruments, and by changes of the input.

    Parameters
    ----------
    shared : (7,), order of ``SHARED``; local : (m, 7), order of ``LOCAL``.
    columns : (N, 3 + k), which receives the derivatives. The first three are those by the vane's arm, the
        accelerometer's arm and the delay of the angle of attack. The start of a record stays in place.

    Returns
    -------
    False where the parameters make the model overflow.
    """
    kinds = len(grid.step_s)
    table = np.empty((kinds, WIDTH))
    parts = np.empty(kinds, np.int64)
    if not fill_transitions(grid, shared, table, parts):
        return False
    columns[:] = 0.0
    for m in range(len(grid.first) - 1):
        _respond_in(grid, m, shared, local[m], table, parts, change, columns)
    return True


@kernel()
def _respond_in(
    grid: Grid,
    m: int,
    shared: FloatArray,
    local: FloatArray,
    table: FloatArray,
    parts: Index,
    change: InputChange,
    columns: FloatArray,
) -> None:
    """Write the columns of manoeuvre ``m``; arguments as in ``response._respond_in``."""
    z_delta, m_delta = shared[2], shared[5]
    width = change.at.shape[1]
    moved = np.zeros((3, width))
    alpha, q = local[2], local[3]
    begin, end = grid.first[m], grid.first[m + 1]
    before = (np.nan, np.nan)
    for e in range(begin, end):
        i, known, turned = grid.kind[e], grid.known[e], grid.turned[e]
        s = grid.ratio[i]
        vane = grid.vane[e]
        after = rates(s, grid.start[e], known, turned, shared, local, alpha, q)
        if e == begin:
            before = after
        elif e + 1 == end:
            after = before
        row = grid.row[0, e]
        if row >= 0:
            turning = vane * ((before[1] + after[1]) / 2.0 - q * grid.acceleration[e] / grid.airspeed[e])
            columns[row, BY_VANE] = -q / grid.airspeed[e]
            columns[row, BY_ALPHA_DELAY] = -(before[0] + after[0]) / 2.0 - turning
            for j in range(width):
                columns[row, N_READING + j] = moved[0, j] + vane * moved[1, j]
        for output, state in ((1, 1), (3, 2)):
            row = grid.row[output, e]
            if row >= 0:
                for j in range(width):
                    columns[row, N_READING + j] = moved[state, j]
        row = grid.row[2, e]
        if row >= 0:
            alpha_dot, q_dot = rates(s, grid.elevator[e], known, turned, shared, local, alpha, q)
            by_alpha, by_q, by_delta = force_slopes(
                s, grid.airspeed[e], grid.acceleration[e], grid.arm, shared, alpha, alpha_dot - q
            )
            columns[row, BY_ACCELEROMETER] = -q_dot
            for j in range(width):
                columns[row, N_READING + j] = (
                    by_alpha * moved[0, j] + by_q * moved[1, j] + by_delta * change.at[e, j]
                )
        if e + 1 == end:
            break
        for j in range(width):
            moved[0, j] += s * z_delta * change.impulse[e, j]
            moved[1, j] += s * s * m_delta * change.impulse[e, j]
        h = grid.step_s[i] / parts[i]
        for part in range(parts[i]):
            for j in range(width):
                there, rate = change.start[e, j] + part * h * change.slope[e, j], change.slope[e, j]
                moved[0, j], moved[1, j], moved[2, j] = advanced(
                    table[i], moved[0, j], moved[1, j], moved[2, j],
                    s * z_delta * there, s * s * m_delta * there,
                    s * z_delta * rate, s * s * m_delta * rate,
                )  # fmt: skip
            delta, rate = grid.start[e] + part * h * grid.slope[e], grid.slope[e]
            alpha, q, _ = advanced(
                table[i], alpha, q, 0.0,
                s * (local[0] + z_delta * delta) + known, s * s * (local[1] + m_delta * delta) + turned,
                s * z_delta * rate, s * s * m_delta * rate,
            )  # fmt: skip
        arrived = grid.start[e] + grid.step_s[i] * grid.slope[e]
        before = rates(s, arrived, known, turned, shared, local, alpha, q)
