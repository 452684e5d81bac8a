"""The model solved on the union of all stamps, with exact sensitivities.

*Interpolate the model, not the data.* The input is linear (or held) between its own stamps. Between two
neighbouring stamps of any channel the solution is therefore known in closed form (``transition``), and each
output is read off exactly where it was measured. Gaps and irregular sampling need no special case.

Parameters of one manoeuvre, in this order: what all share, ``SHARED``, then its own
``LOCAL``. With the air speed ratio s = V/V_ref of a step, the model is

    α̇ = s·(Z_0 + Z_α·α + Z_δe·δe) + (1 + Z_q)·q + g(t)
    q̇ = s²·(M_0 + M_α·α + M_δe·δe) + s·M_q·q
    θ̇ = q

and the outputs are, with the vane x_α and the accelerometer x_a ahead of the centre of gravity,

    α_m = α - (x_α/V)·q                       q_m = q + b_q
    a_z = (1 + k)·V·cos α·(α̇ - q) + V̇·sin α - g·cos θ·cos φ - x_a·q̇ + b_a        θ_m = θ

with k the scale error of the air speed (a_z: specific force along body z; Klein & Morelli,
*Aircraft System Identification*, Ch. 3).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from advisor.model import outputs
from advisor.model.transition import WIDTH, divisions, fill
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

Index = NDArray[np.int64]

OUTPUTS = outputs.OUTPUTS
SHARED = ("Z_alpha", "Z_q", "Z_delta_e", "M_alpha", "M_q", "M_delta_e", "airspeed_scale")
LOCAL = ("Z_0", "M_0", "alpha_initial", "q_initial", "theta_initial", "q_bias", "a_z_bias")
N_SHARED, N_LOCAL = len(SHARED), len(LOCAL)
N_PARAMETERS = N_SHARED + N_LOCAL
N_MOVING = N_SHARED + 4
"""Number of parameters that affect α and q; the other parameters only affect the outputs."""


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
    vane, known = grid.vane, grid.known
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
            force = _specific_force(
                grid.ratio[kind[e]],
                grid.elevator[e],
                known[e],
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
            u2 = s * s * (m_0 + m_delta * delta)
            v1, v2 = s * z_delta * slope[e], s * s * m_delta * slope[e]
            if wanted:
                _carry(table[i], s, shared, alpha, q, u1, u2, v1, v2, delta, slope[e], state, attitude)
            alpha, q, theta = advanced(table[i], alpha, q, theta, u1, u2, v1, v2)
    finite: bool = abs(alpha) + abs(q) < 1e12
    return finite


@kernel()
def advanced(
    t: FloatArray, alpha: float, q: float, theta: float, u1: float, u2: float, v1: float, v2: float
) -> tuple[float, float, float]:
    """Return α, q and θ after one step, with the row ``t`` of ``transition.fill``.

    u + v·t is the part of the rates that does not depend on α and q.
    """
    return (
        t[0] * alpha + t[1] * q + t[13] * u1 + t[14] * u2 + t[26] * v1 + t[27] * v2,
        t[2] * alpha + t[3] * q + t[15] * u1 + t[16] * u2 + t[28] * v1 + t[29] * v2,
        theta + t[15] * alpha + t[16] * q + t[28] * u1 + t[29] * u2 + t[41] * v1 + t[42] * v2,
    )


@kernel()
def rates(
    s: float, delta: float, known: float, shared: FloatArray, local: FloatArray, alpha: float, q: float
) -> tuple[float, float]:
    """Return α̇ and q̇ of the model."""
    return (
        s * shared[0] * alpha + (1.0 + shared[1]) * q + s * (shared[2] * delta + local[0]) + known,
        s * s * shared[3] * alpha + s * shared[4] * q + s * s * (shared[5] * delta + local[1]),
    )


@kernel()
def force_slopes(
    s: float,
    airspeed: float,
    acceleration: float,
    arm: float,
    shared: FloatArray,
    alpha: float,
    turning: float,
) -> tuple[float, float, float]:
    """Return the derivatives of a_z by α, q and δe, where ``turning`` is α̇ - q."""
    speed = (1.0 + shared[6]) * airspeed
    lift = speed * math.cos(alpha)
    return (
        lift * s * shared[0]
        - speed * math.sin(alpha) * turning
        + acceleration * math.cos(alpha)
        - arm * s * s * shared[3],
        lift * shared[1] - arm * s * shared[4],
        lift * s * shared[2] - arm * s * s * shared[5],
    )


@kernel()
def _carry(
    t: FloatArray,
    s: float,
    shared: FloatArray,
    alpha: float,
    q: float,
    u1: float,
    u2: float,
    v1: float,
    v2: float,
    delta: float,
    slope: float,
    state: FloatArray,
    attitude: bool,
) -> None:
    """Advance the sensitivities ``state`` (3, 14) of α, q and, on request, θ over one step from (α, q)."""
    a11, a12, a21, a22 = s * shared[0], 1.0 + shared[1], s * s * shared[3], s * shared[4]
    t0, t1, t2, t3 = t[0], t[1], t[2], t[3]
    if attitude:
        for j in range(N_MOVING):
            state[2, j] += t[15] * state[0, j] + t[16] * state[1, j]
    for j in range(N_MOVING):
        f, k = state[0, j], state[1, j]
        state[0, j] = t0 * f + t1 * k
        state[1, j] = t2 * f + t3 * k
    # by the trace (p), by the determinant (d), by A itself (w)
    p1 = t[4] * alpha + t[5] * q + t[17] * u1 + t[18] * u2 + t[30] * v1 + t[31] * v2
    p2 = t[6] * alpha + t[7] * q + t[19] * u1 + t[20] * u2 + t[32] * v1 + t[33] * v2
    d1 = t[8] * alpha + t[9] * q + t[21] * u1 + t[22] * u2 + t[34] * v1 + t[35] * v2
    d2 = t[10] * alpha + t[11] * q + t[23] * u1 + t[24] * u2 + t[36] * v1 + t[37] * v2
    w1 = t[12] * alpha + t[25] * u1 + t[38] * v1
    w2 = t[12] * q + t[25] * u2 + t[38] * v2
    state[0, 0] += s * (p1 + a22 * d1 + w1)
    state[1, 0] += s * (p2 + a22 * d2)
    state[0, 1] += -a21 * d1 + w2
    state[1, 1] += -a21 * d2
    state[0, 3] += s * s * (-a12 * d1)
    state[1, 3] += s * s * (-a12 * d2 + w1)
    state[0, 4] += s * (p1 + a11 * d1)
    state[1, 4] += s * (p2 + a11 * d2 + w2)
    # by Z_δe and M_δe, by Z_0 and M_0
    state[0, 2] += s * (t[13] * delta + t[26] * slope)
    state[1, 2] += s * (t[15] * delta + t[28] * slope)
    state[0, 5] += s * s * (t[14] * delta + t[27] * slope)
    state[1, 5] += s * s * (t[16] * delta + t[29] * slope)
    state[0, 7] += s * t[13]
    state[1, 7] += s * t[15]
    state[0, 8] += s * s * t[14]
    state[1, 8] += s * s * t[16]
    if attitude:
        p3 = t[19] * alpha + t[20] * q + t[32] * u1 + t[33] * u2 + t[45] * v1 + t[46] * v2
        d3 = t[23] * alpha + t[24] * q + t[36] * u1 + t[37] * u2 + t[49] * v1 + t[50] * v2
        w1_theta = t[25] * alpha + t[38] * u1 + t[51] * v1
        w2_theta = t[25] * q + t[38] * u2 + t[51] * v2
        state[2, 0] += s * (p3 + a22 * d3)
        state[2, 1] += -a21 * d3
        state[2, 3] += s * s * (-a12 * d3 + w1_theta)
        state[2, 4] += s * (p3 + a11 * d3 + w2_theta)
        state[2, 2] += s * (t[28] * delta + t[41] * slope)
        state[2, 5] += s * s * (t[29] * delta + t[42] * slope)
        state[2, 7] += s * t[28]
        state[2, 8] += s * s * t[29]


@kernel()
def _specific_force(
    s: float,
    delta: float,
    known: float,
    airspeed: float,
    acceleration: float,
    arm: float,
    shared: FloatArray,
    local: FloatArray,
    alpha: float,
    q: float,
    state: FloatArray,
    row: FloatArray,
) -> float:
    """Return a_z without gravity and bias, from α̇ and q̇ of the model; derivatives into ``row`` (14,) or
    (0,)."""
    alpha_dot, q_dot = rates(s, delta, known, shared, local, alpha, q)
    lift = (1.0 + shared[6]) * airspeed * math.cos(alpha)
    force: float = lift * (alpha_dot - q) + acceleration * math.sin(alpha) - arm * q_dot
    if len(row) == 0:
        return force
    by_alpha, by_q, _ = force_slopes(s, airspeed, acceleration, arm, shared, alpha, alpha_dot - q)
    for j in range(N_PARAMETERS):
        row[j] = by_alpha * state[0, j] + by_q * state[1, j]
    row[0] += lift * s * alpha
    row[1] += lift * q
    row[2] += lift * s * delta
    row[3] -= arm * s * s * alpha
    row[4] -= arm * s * q
    row[5] -= arm * s * s * delta
    row[6] += airspeed * math.cos(alpha) * (alpha_dot - q)
    row[7] += lift * s
    row[8] -= arm * s * s
    row[13] += 1.0
    return force
