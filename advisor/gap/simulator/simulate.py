"""The simulator under diagnosis: short-period motion at a measured air speed, with every candidate effect.

The equations are Eqs. (1)-(2) about the trim of each manoeuvre, with exact kinematics of accelerometer and
attitude. Where the air speed is measured, derivatives scale with it. Terms of the effects are of low order,
and an entry of zero switches each off (``advisor.gap.simulator.layout``).

    v = V/V_r,  Δα = α − α_trim,  Δδ = δ − δ_trim
    N  = v (1 + k_h e^(−h/b)) (Z_trim + Z_α Δα_e + Z_δe Δδ + ...) + Z_q q       normal force over m·V
    α̇ = q + G + N,   G = (g/V)(cos α cos θ cos φ + sin α sin θ)
    q̇ = v² (M_trim + M_α Δα + M_δe Δδ + ...) + v (M_q q + M_|q| |q| + M_α̇ α̇) + M_T ΔT + M_P (1 − v²)
    θ̇ = q cos φ − r sin φ,   a_z cos α = V N + a_x sin α

Where forces do not grow with V², lift is also multiplied by v^n, and moments of α and δ by v^m. V is the
measured air speed plus a parabola in time for its error. The last equation is the exact a_z = V cos α (α̇ −
q) + V̇ sin α − g cos θ with V̇ taken from a_x.

A step depends on the step before, so a single simulation leaves most of the processor idle. Many parameter
sets fly the same inputs. The loop therefore advances a pack of simulations side by side, in the time of one
simulation.
"""

import numpy as np

from advisor.gap.simulator.layout import AT, DISTURBED, LAYOUT, OTHER_LAYOUT, READ, SLOW, TRIM
from advisor.gap.simulator.pack import LANES, ROWS, begin
from advisor.gap.simulator.step import (
    advance,
    hold_over_step,
    near_ground,
    rates,
    read_sensors,
    stall,
    take_speed,
)
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel


@kernel(error_model="numpy", fastmath={"contract"})
def simulate(
    layout: int,
    h: float,
    deflections: FloatArray,
    moved: np.ndarray,
    lanes: int,
    slow: FloatArray,
    disturbance: FloatArray,
    doses: FloatArray,
    trim: FloatArray,
    p: FloatArray,
) -> FloatArray:
    """Fly one manoeuvre with several sets of parameters.

    Parameters
    ----------
    layout
        ``layout.LAYOUT``, which defines the order of ``p`` and of the other arrays.
    h
        Step in s.
    deflections, moved
        Result of ``surfaces``.
    lanes
        ``LANES``, as in ``advisor.gap.simulator.step``.
    slow
        Shape (10, n). Speed (m/s), a_x (m/s²), bank (rad), throttle relative to its start, height (m), thrust
        minus drag over weight relative to its mean, r sin φ (rad/s), which a turn subtracts from θ̇, the rate
        of α by rolling in sideslip (rad/s), p·r and r² - p² (rad²/s²).
    disturbance
        Shape (4, n), or (4, 0) for none: added to δ, α̇, q̇ and the angle of the air.
    doses
        Shape (k,): factor of the disturbance in each simulation.
    trim
        Shape (4,): α and θ at the start, reference speed, and 1 if derivatives scale with speed.
    p
        Shape (k, entries): simulator inputs of each simulation, in the order of ``layout.ENTRIES``.

    Returns
    -------
    Shape (packs, n + 1, 4, LANES): α and q as their sensors read them, a_z at the accelerometer, θ; of
    simulation j in lane j % LANES of pack j // LANES. Spare lanes repeat the last simulation.

    Raises
    ------
    ValueError
        The simulation was compiled for another layout.
    """
    if layout != LAYOUT or p.shape[1] != len(AT):
        raise ValueError(OTHER_LAYOUT)
    packs, n = (len(p) + LANES - 1) // LANES, deflections.shape[2]
    out = np.empty((packs, n + 1, len(READ), LANES))
    x, which = np.empty((ROWS, LANES)), np.empty(LANES, dtype=np.int64)
    delta, above = np.empty(LANES), np.empty(LANES)
    alpha_trim, reference, scaled = trim[TRIM.alpha], trim[TRIM.reference], trim[TRIM.scaled] > 0.5
    disturbed = disturbance.shape[1] == n
    level = np.cos(slow[SLOW.bank])
    d_delta, d_force, d_moment, d_air = 0.0, 0.0, 0.0, 0.0
    for k in range(packs):
        low, stalls, powers, separates = False, False, False, False
        for m in range(LANES):
            j = min(k * LANES + m, len(p) - 1)
            which[m] = moved[j]
            begin(x, m, p[j], doses[j], h, slow[SLOW.speed, 0], trim)
            low, stalls = low or p[j, AT.scale_m] > 0.0, stalls or p[j, AT.stall_sharpness] > 0.0
            powers = powers or p[j, AT.speed_power] != 0.0 or p[j, AT.moment_power] != 0.0
            separates = separates or p[j, AT.separation_rad] != 0.0
        for i in range(n + 1):
            j = min(i, n - 1)
            if disturbed:
                d_delta, d_force = disturbance[DISTURBED.input, j], disturbance[DISTURBED.force, j]
                d_moment, d_air = disturbance[DISTURBED.moment, j], disturbance[DISTURBED.air, j]
            take_speed(x, lanes, slow[SLOW.speed, j], 2.0 * j / n - 1.0, reference, scaled, powers)
            if low:
                near_ground(x, lanes, slow[SLOW.height, j])
            for m in range(LANES):
                delta[m], above[m] = deflections[which[m], 0, j], deflections[which[m], 1, j]
            forced = (d_delta, d_force, d_moment)
            hold_over_step(x, lanes, delta, above, slow[:, j], level[j], forced)
            # The midpoint rule: with a step of a hundredth of the period, its error is far below that of any
            # derivative.
            for stage in range(2):
                if stalls:
                    stall(x, lanes, h, d_air)
                rates(x, lanes, h, d_air, alpha_trim, stage == 0)
            read_sensors(x, lanes, out[k, i], d_air, slow[:, j], trim)
            advance(x, lanes, h, alpha_trim, level[j], slow[SLOW.turn, j], separates)
    return out
