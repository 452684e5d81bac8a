"""One step of the short period in closed form, with its sensitivities, and the specific force.

The arguments are scalars and rows, because passing a grid costs as much time as a step.
"""

import math

from advisor.model.outputs import N_MOVING, N_PARAMETERS
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


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
    s: float, delta: float, known: float, turned: float, shared: FloatArray, local: FloatArray,
    alpha: float, q: float,
) -> tuple[float, float]:  # fmt: skip
    """Return α̇ and q̇ of the model; ``known`` and ``turned`` are their known parts."""
    return (
        s * shared[0] * alpha + (1.0 + shared[1]) * q + s * (shared[2] * delta + local[0]) + known,
        s * s * shared[3] * alpha + s * shared[4] * q + s * s * (shared[5] * delta + local[1]) + turned,
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
def carry(
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
def specific_force(
    s: float,
    delta: float,
    known: float,
    turned: float,
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
    alpha_dot, q_dot = rates(s, delta, known, turned, shared, local, alpha, q)
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
