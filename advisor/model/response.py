"""The model solved on the union of all stamps, with exact sensitivities.

*Interpolate the model, not the data.* The input is linear (or held) between its own stamps. Between two
neighbouring stamps of any channel the solution is therefore known in closed form (``transition``), and each
output is evaluated exactly at its stamps. Gaps and irregular sampling need no special case.

Parameters of one manoeuvre, in this order: the shared parameters ``SHARED``, then the manoeuvre's own
``LOCAL``. With the air speed ratio s = V/V_ref of a step, the model is

    α̇ = s·(Z_0 + Z_α·α + Z_δe·δe) + (1 + Z_q)·q + g(t)
    q̇ = s²·(M_0 + M_α·α + M_δe·δe) + s·M_q·q + m(t)
    θ̇ = q

and the outputs are, with the vane x_α and the accelerometer x_a ahead of the centre of gravity,

    α_m = α - (x_α/V)·q                       q_m = q + b_q
    a_z = (1 + k)·V·cos α·(α̇ - q) + V̇·sin α - g·cos θ·cos φ - x_a·q̇ + b_a        θ_m = θ

with k the scale error of the air speed (a_z: specific force along body z; Klein & Morelli,
*Aircraft System Identification*, Ch. 3).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from advisor.model.outputs import N_PARAMETERS
from advisor.model.short_period_step import advanced, carry, specific_force
from advisor.model.transition import WIDTH, divisions, fill
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

Index = NDArray[np.int64]


class Grid(NamedTuple):
    """All manoeuvres of a problem on the union of their stamps, one after another.

    E events in all, U different kinds of step between them, N measurements.
    """

    first: Index
    """(m + 1,) index of the first event of each manoeuvre, and E."""
    kind: Index
    """(E,) kind of the step to the next event; at a manoeuvre's last event, of the step to that event."""
    step_s: FloatArray
    """(U,) length of the step."""
    ratio: FloatArray
    """(U,) air speed ratio s on the step, relative to the reference speed."""
    elevator: FloatArray
    """(E,) δe at the event."""
    start: FloatArray
    """(E,) δe just after the event (differs from ``elevator`` only where a held input jumps)."""
    slope: FloatArray
    """(E,) rate of δe on the step, rad/s."""
    known: FloatArray
    """(E,) g(t), the known contribution to α̇ beyond the model, rad/s, constant over the step."""
    turned: FloatArray
    """(E,) m(t), the known contribution to q̇ beyond the model, rad/s², constant over the step."""
    row: Index
    """(4, E) row of the measurement of each output of ``OUTPUTS`` at the event, -1 for none."""
    vane: FloatArray
    """(E,) -x_α/V in s."""
    airspeed: FloatArray
    """(E,) V in m/s; used by a_z only."""
    acceleration: FloatArray
    """(E,) V̇ in m/s²; used by a_z only."""
    gravity: FloatArray
    """(E,) g·cos θ·cos φ in m/s²; used by a_z only."""
    arm: float
    """x_a in m."""


@kernel()
def respond(grid: Grid, shared: FloatArray, local: FloatArray, y: FloatArray, g: FloatArray) -> bool:
    """Solve the model and write outputs and sensitivities.

    Parameters
    ----------
    shared : (7,), order of ``SHARED``.
    local : (m, 7), order of ``LOCAL``.
    y : (N,), which receives the outputs.
    g : (N, 14) receives their derivatives by the parameters of the row's manoeuvre; with
        shape (0, 14) only the outputs are computed.

    Returns
    -------
    False where the parameters make the model overflow; ``y`` and ``g`` are then useless.
    """
    kinds = len(grid.step_s)
    table = np.empty((kinds, WIDTH))
    parts = np.empty(kinds, np.int64)
    if not fill_transitions(grid, shared, table, parts):
        return False
    state = np.empty((3, N_PARAMETERS))
    attitude = grid.row[3].max() >= 0
    for m in range(len(grid.first) - 1):
        if not _respond_in(grid, m, shared, local[m], table, parts, state, attitude, y, g):
            return False
    return True


@kernel()
def fill_transitions(grid: Grid, shared: FloatArray, table: FloatArray, parts: Index) -> bool:
    """Write the exact solution over each kind of step.

    Parameters
    ----------
    shared : (7,), order of ``SHARED``.
    table : (kinds, WIDTH) receives the solution over one part of the step, as ``transition.fill`` writes it.
    parts : (kinds,) receives in how many equal parts the step is taken.

    Returns
    -------
    False when no division of a step is short enough for the model.
    """
    z_alpha, z_q, m_alpha, m_q = shared[0], shared[1], shared[3], shared[4]
    for i in range(len(grid.step_s)):
        s = grid.ratio[i]
        a11, a12, a21, a22 = s * z_alpha, 1.0 + z_q, s * s * m_alpha, s * m_q
        parts[i] = divisions(a11, a12, a21, a22, grid.step_s[i])
        if parts[i] == 0:
            return False
        fill(table[i], a11, a12, a21, a22, grid.step_s[i] / parts[i])
    return True


@kernel()
def _respond_in(
    grid: Grid,
    m: int,
    shared: FloatArray,
    local: FloatArray,
    table: FloatArray,
    parts: Index,
    state: FloatArray,
    attitude: bool,
    y: FloatArray,
    g: FloatArray,
) -> bool:
    """Solve the model over manoeuvre ``m``.

    Parameters
    ----------
    shared : (7,), order of ``SHARED``; local : (7,), order of ``LOCAL``.
    table, parts : as ``fill_transitions`` writes them.
    state : (3, 14), overwritten: derivatives of α, q and θ by all parameters.
    attitude : whether any manoeuvre measures θ.
    y, g : as ``respond`` takes them.

    Returns
    -------
    False when the parameters make the model overflow.
    """
    wanted = g.shape[0] > 0
    z_delta, m_delta = shared[2], shared[5]
    nothing = np.empty(0)
    rows, kind, start, slope = grid.row, grid.kind, grid.start, grid.slope
    vane, known, turned = grid.vane, grid.known, grid.turned
    begin, end = grid.first[m], grid.first[m + 1]
    z_0, m_0 = local[0], local[1]
    alpha, q, theta = local[2], local[3], local[4]
    state[:] = 0.0
    state[0, 9] = state[1, 10] = state[2, 11] = 1.0
    for e in range(begin, end):
        row = rows[0, e]
        if row >= 0:
            y[row] = alpha + vane[e] * q
            if wanted:
                for j in range(N_PARAMETERS):
                    g[row, j] = state[0, j] + vane[e] * state[1, j]
        row = rows[1, e]
        if row >= 0:
            y[row] = q + local[5]
            if wanted:
                for j in range(N_PARAMETERS):
                    g[row, j] = state[1, j]
                g[row, 12] += 1.0
        row = rows[3, e]
        if row >= 0:
            y[row] = theta
            if wanted:
                g[row] = state[2]
        row = rows[2, e]
        if row >= 0:
            force = specific_force(
                grid.ratio[kind[e]],
                grid.elevator[e],
                known[e],
                turned[e],
                grid.airspeed[e],
                grid.acceleration[e],
                grid.arm,
                shared,
                local,
                alpha,
                q,
                state,
                g[row] if wanted else nothing,
            )
            y[row] = force - grid.gravity[e] + local[6]
        if e + 1 == end:
            break
        i = kind[e]
        s = grid.ratio[i]
        h = grid.step_s[i] / parts[i]
        for part in range(parts[i]):
            delta = start[e] + part * h * slope[e]
            u1 = s * (z_0 + z_delta * delta) + known[e]
            u2 = s * s * (m_0 + m_delta * delta) + turned[e]
            v1, v2 = s * z_delta * slope[e], s * s * m_delta * slope[e]
            if wanted:
                carry(table[i], s, shared, alpha, q, u1, u2, v1, v2, delta, slope[e], state, attitude)
            alpha, q, theta = advanced(table[i], alpha, q, theta, u1, u2, v1, v2)
    finite: bool = abs(alpha) + abs(q) < 1e12
    return finite
