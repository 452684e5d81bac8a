"""The simulator under diagnosis: short-period motion at a measured air speed, with every effect in it.

Eqs. (1)-(2) about the trim of each manoeuvre, with the exact kinematics of the accelerometer and
the attitude and, where the speed is measured, derivatives that scale with it. The low-order terms
of the candidate effects are in the same loop, each switched off by a zero (``advisor.gap.simulator.layout``).

    v = V/V_r,  Δα = α − α_trim,  Δδ = δ − δ_trim
    N  = v (1 + k_h e^(−h/b)) (Z_trim + Z_α Δα_e + Z_δe Δδ + ...) + Z_q q       normal force over m·V
    α̇ = q + G + N,   G = (g/V)(cos α cos θ cos φ + sin α sin θ)
    q̇ = v² (M_trim + M_α Δα + M_δe Δδ + ...) + v (M_q q + M_|q| |q| + M_α̇ α̇) + M_T ΔT + M_P (1 − v²)
    θ̇ = q cos φ − r sin φ,   a_z cos α = V N + a_x sin α

Where forces do not go with V², lift is multiplied by v^n besides, and all moments of α and δ by v^m. V is
what was measured, and a parabola in time that it may be wrong by. The last is the exact
a_z = V cos α (α̇ − q) + V̇ sin α − g cos θ with V̇ replaced by what a_x measures.

A step has to wait for the one before, which leaves a processor idle. Many sets of parameters are flown with
the same inputs, so the loop advances a pack of them side by side, each in a lane: it takes the time of one.
"""

import numpy as np

from advisor.compiled import kernel
from advisor.flight.messages import FloatArray
from advisor.gap.simulator.circle import cos_sin
from advisor.gap.simulator.layout import AT, DISTURBED, LAYOUT, OTHER_LAYOUT, READ, SLOW, TRIM
from advisor.standard_gravity import GRAVITY_M_S2

LANES = 8
"""Simulations in a pack: the numbers in the widest registers."""
_ANYWHERE = 9.0
"""Angle of a vane without stops, rad."""
# Rows of a pack behind the driving numbers: what follows from them once, the state, what a step hands on.
(
    DOSE, ENGINE_DECAY, LIFT_DECAY, VANE_DECAY, VANE_RAMP, FADE, SWING_COS, SWING_SIN, SOFTNESS,
    ALPHA, Q, THETA, ENGINE, LIFT, FOLLOWED, VANE_BEFORE, VANE_OUT, SHOWN,
    HIGHEST, LOWEST, SEPARATED, MISSING, BEND, BEND_RATE,
    AIRSPEED, RATIO, NEAR, POWER, TURNING, ATTACHED, COS_ALPHA, SIN_ALPHA, GRAVITY, LIFTING, MOMENT_SLOPE,
    DEFLECTION, Z_REST, M_REST, KA, KQ, NORMAL_0, QDOT_0, ROWS,
) = range(len(AT), len(AT) + 43)  # fmt: skip


@kernel()
def _attached(beyond: float) -> float:
    """Share of the lift that is left, the flow separated over half the chord at 0 (Kirchhoff's flow)."""
    chord = 1.0 / (1.0 + np.exp(2.0 * beyond))
    return float(0.25 * (1.0 + np.sqrt(chord)) ** 2)


@kernel(error_model="numpy")
def _separate(x: FloatArray, m: int, before: float, now: float) -> None:
    """The flow separates above one angle, and attaches again below another: a relay's memory.

    What a step misses because the angle was met within it is made up for in the next one.
    """
    x[MISSING, m] = x[SEPARATED, m]
    if x[SEPARATED, m] == 0.0 and now > x[AT.separation_rad, m]:
        late = (now - x[AT.separation_rad, m]) / max(now - before, 1e-9)
        x[SEPARATED, m], x[MISSING, m] = 1.0, 1.0 + min(late, 1.0)
    elif x[SEPARATED, m] == 1.0 and now < x[AT.attachment_rad, m]:
        late = (x[AT.attachment_rad, m] - now) / max(before - now, 1e-9)
        x[SEPARATED, m], x[MISSING, m] = 0.0, -min(late, 1.0)


@kernel(error_model="numpy")
def _begin(
    x: FloatArray, lane: int, p: FloatArray, dose: float, h: float, speed: float, trim: FloatArray
) -> None:
    """Fill a lane of a pack with its driving numbers, what follows from them, and the state at the start."""
    x[: len(p), lane] = p
    x[DOSE, lane] = dose
    x[ENGINE_DECAY, lane] = np.exp(-h / max(p[AT.engine_lag_s], 1e-3 * h))
    x[LIFT_DECAY, lane] = np.exp(-h / max(p[AT.lift_lag_s], 0.2 * h))
    # First order in the lag, so that the sensitivity to a lag exists at no lag at all.
    tau = p[AT.alpha_lag_s]
    decay = np.exp(-h / tau) if tau > 1e-6 else 0.0
    x[VANE_DECAY, lane], x[VANE_RAMP, lane] = decay, (tau / h) * (1.0 - decay)
    # The mode is solved exactly: it is fast beside the step. ``SWING_SIN`` is sin(ω_d h) ω/ω_d.
    omega, zeta = p[AT.mode_rad_s], p[AT.mode_damping]
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    x[FADE, lane] = np.exp(-zeta * omega * h)
    x[SWING_COS, lane] = np.cos(omega * damped * h)
    x[SWING_SIN, lane] = np.sin(omega * damped * h) / damped
    x[SOFTNESS, lane] = 1.0 / omega if omega > 0.0 else 0.0
    x[ALPHA, lane], x[Q, lane] = trim[TRIM.alpha] + p[AT.alpha_start], p[AT.q_start]
    x[THETA, lane] = trim[TRIM.theta]
    x[ENGINE, lane], x[LIFT, lane], x[FOLLOWED, lane] = 0.0, trim[TRIM.alpha], x[ALPHA, lane]
    x[VANE_OUT, lane] = x[ALPHA, lane] - p[AT.vane_arm_m] * x[Q, lane] / speed
    x[VANE_BEFORE, lane] = x[VANE_OUT, lane]
    x[SHOWN, lane] = x[VANE_OUT, lane]
    x[SEPARATED, lane], x[MISSING, lane] = 0.0, 0.0
    up, down = p[AT.vane_stop_up_rad], p[AT.vane_stop_down_rad]
    x[HIGHEST, lane] = up if up > 0.0 else _ANYWHERE
    x[LOWEST, lane] = -down if down > 0.0 else -_ANYWHERE
    x[BEND, lane], x[BEND_RATE, lane] = 0.0, 0.0
    x[NEAR, lane], x[POWER, lane], x[TURNING, lane], x[ATTACHED, lane] = 0.0, 1.0, 1.0, 1.0


@kernel(error_model="numpy", fastmath={"contract"})
def simulate(
    layout: int,
    h: float,
    delta: FloatArray,
    above: FloatArray,
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
        ``layout.LAYOUT``, which says how ``p`` and the other arrays are laid out.
    h
        Step in s.
    delta
        Shape (packs, n, LANES). Mean deflection over each step relative to trim, from ``surfaces``.
    above
        Shape (packs, n, LANES). What that is above the deflection at the step's start.
    slow
        Shape (7, n). Speed m/s, a_x m/s², bank rad, throttle relative to its start, height m, thrust less
        drag over weight, less its mean, and what a turn takes from θ̇, r sin φ, rad/s.
    disturbance
        Shape (4, n), or (4, 0) for none: added to δ, α̇, q̇ and the angle of the air.
    doses
        Shape (k,). How much of the disturbance each simulation gets.
    trim
        Shape (4,). α, θ at the start, reference speed; and 1 when derivatives scale with speed.
    p
        Shape (k, entries). Parameters of each simulation laid out as ``layout.ENTRIES``.

    Returns
    -------
    Shape (packs, n + 1, 4, LANES): α and q as their sensors read them, a_z at the accelerometer, θ; of
    simulation j in lane j % LANES of pack j // LANES. Lanes to spare repeat the last.

    Raises
    ------
    ValueError
        The simulation was compiled for another layout.
    """
    if layout != LAYOUT or p.shape[1] != len(AT):
        raise ValueError(OTHER_LAYOUT)
    # As many as LANES, but known only at run time: else the lanes are unrolled one after the other.
    packs, n, lanes = delta.shape
    out = np.empty((packs, n + 1, len(READ), LANES))
    x = np.empty((ROWS, LANES))
    alpha_trim, theta_from, reference = trim[TRIM.alpha], trim[TRIM.theta], trim[TRIM.reference]
    scaled = trim[TRIM.scaled] > 0.5
    disturbed = disturbance.shape[1] == n
    level = np.cos(slow[SLOW.bank])
    d_delta, d_force, d_moment, d_air = 0.0, 0.0, 0.0, 0.0
    for k in range(packs):
        low, stalls, other_power, separates = False, False, False, False
        for m in range(LANES):
            j = min(k * LANES + m, len(p) - 1)
            _begin(x, m, p[j], doses[j], h, slow[SLOW.speed, 0], trim)
            low, stalls = low or p[j, AT.scale_m] > 0.0, stalls or p[j, AT.stall_sharpness] > 0.0
            other_power = other_power or p[j, AT.speed_power] != 0.0 or p[j, AT.moment_power] != 0.0
            separates = separates or p[j, AT.separation_rad] != 0.0
        for i in range(n + 1):
            j = min(i, n - 1)
            a_x, cb, turning = slow[SLOW.a_x, j], level[j], slow[SLOW.turn, j]
            throttle, height = slow[SLOW.throttle, j], slow[SLOW.height, j]
            along = 2.0 * j / n - 1.0
            for m in range(lanes):
                bowed = x[AT.speed_slope_m_s, m] + along * x[AT.speed_bow_m_s, m]
                off = x[AT.speed_level_m_s, m] + along * bowed
                # Derivatives are given at the speed as it is read; what bends the path is the true one.
                x[AIRSPEED, m] = (slow[SLOW.speed, j] + off) * (1.0 + x[AT.speed_scale, m])
                x[RATIO, m] = (slow[SLOW.speed, j] + off) / reference if scaled else 1.0
            if disturbed:
                d_delta, d_force = disturbance[DISTURBED.input, j], disturbance[DISTURBED.force, j]
                d_moment, d_air = disturbance[DISTURBED.moment, j], disturbance[DISTURBED.air, j]
            if other_power:
                for m in range(lanes):
                    x[POWER, m] = x[RATIO, m] ** x[AT.speed_power, m]
                    x[TURNING, m] = x[POWER, m] * x[RATIO, m] ** x[AT.moment_power, m]
            if low:
                scale, near = 0.0, 0.0
                for m in range(lanes):
                    if x[AT.scale_m, m] != scale:
                        scale = x[AT.scale_m, m]
                        # Heights count from a place that may lie above the ground; a trial scale may be tiny.
                        near = np.exp(min(-height / max(scale, 1e-3), 3.0)) if scale > 0.0 else 0.0
                    x[NEAR, m] = near
            for m in range(lanes):
                d = delta[k, j, m] + x[DOSE, m] * d_delta
                v = x[RATIO, m]
                vv = v * v
                z_d = x[AT.Z_delta_e, m]
                met = vv + x[AT.washed_share, m] * (1.0 - vv) + x[AT.blown_share, m] * slow[SLOW.thrust, j]
                m_d = x[AT.M_delta_e, m] * x[TURNING, m] * met
                pressure = x[TURNING, m] * vv
                lifting = x[POWER, m] * v * (1.0 + x[AT.lift_h, m] * x[NEAR, m])
                ca, sa = cos_sin(x[ALPHA, m])
                ct, st = cos_sin(x[THETA, m])
                x[COS_ALPHA, m], x[SIN_ALPHA, m] = ca, sa
                x[GRAVITY, m] = GRAVITY_M_S2 / x[AIRSPEED, m] * (ca * ct * cb + sa * st)
                x[LIFTING, m] = lifting
                x[ENGINE, m] = throttle + x[ENGINE_DECAY, m] * (x[ENGINE, m] - throttle)
                x[MOMENT_SLOPE, m] = pressure * x[AT.M_alpha, m]
                x[DEFLECTION, m] = d
                x[Z_REST, m] = v * x[AT.Z_h, m] * x[NEAR, m] + x[DOSE, m] * d_force + lifting * z_d * d
                x[M_REST, m] = (
                    m_d * d
                    + pressure * (x[AT.M_trim, m] + (x[AT.M_delta2, m] + x[AT.M_delta3, m] * d) * d * d)
                    + pressure * x[AT.M_h, m] * x[NEAR, m] + x[AT.M_throttle, m] * x[ENGINE, m]
                    + x[AT.M_thrust, m] * (1.0 - vv) + x[DOSE, m] * d_moment
                )  # fmt: skip
                # Outputs belong to the start of the step.
                ahead = above[k, j, m]
                x[NORMAL_0, m], x[QDOT_0, m] = -lifting * z_d * ahead, -m_d * ahead
                x[KA, m], x[KQ, m] = 0.0, 0.0
            # The midpoint rule: at a hundredth of the period a step its error is far below any derivative's.
            for stage in range(2):
                if stalls:
                    for m in range(lanes):
                        if x[AT.stall_sharpness, m] > 0.0:
                            a = x[ALPHA, m] + 0.5 * h * x[KA, m] + x[DOSE, m] * d_air
                            x[ATTACHED, m] = _attached(x[AT.stall_sharpness, m] * (a - x[AT.stall_rad, m]))
                for m in range(lanes):
                    a = x[ALPHA, m] + 0.5 * h * x[KA, m] + x[DOSE, m] * d_air
                    q = x[Q, m] + 0.5 * h * x[KQ, m]
                    da = a - alpha_trim
                    behind = a - x[LIFT, m]
                    lagged, turned = da - x[AT.lift_share, m] * behind, da - x[AT.moment_share, m] * behind
                    wing = (
                        x[AT.Z_trim, m]
                        + (x[AT.Z_alpha, m] + (x[AT.Z_alpha2, m] + x[AT.Z_alpha3, m] * lagged) * lagged)
                        * lagged
                    )
                    wing += x[AT.Z_memory, m] * (a - x[FOLLOWED, m]) + x[AT.Z_separated, m] * x[MISSING, m]
                    normal = x[Z_REST, m] + x[LIFTING, m] * x[ATTACHED, m] * wing + x[AT.Z_q, m] * q
                    ka = q + x[GRAVITY, m] + normal
                    v = x[RATIO, m]
                    bent = (x[AT.M_alpha2, m] + x[AT.M_alpha3, m] * da) * da
                    bent += x[AT.M_alpha_delta_e, m] * x[DEFLECTION, m]
                    slope = x[MOMENT_SLOPE, m] + x[TURNING, m] * v * v * bent
                    damping = x[AT.M_q, m] + x[AT.M_alpha_q, m] * da + x[AT.M_q_q, m] * abs(q)
                    damped = damping * q + x[AT.M_q_abs, m] * abs(q)
                    kq = x[M_REST, m] + slope * turned + v * (damped + x[AT.M_alpha_dot, m] * ka)
                    x[KA, m], x[KQ, m] = ka, kq
                    if stage == 0:
                        x[NORMAL_0, m] += normal
                        x[QDOT_0, m] += kq
            for m in range(lanes):
                alpha, q, theta, d = x[ALPHA, m], x[Q, m], x[THETA, m], x[DEFLECTION, m]
                air = x[DOSE, m] * d_air
                vane = alpha + air - x[AT.vane_arm_m, m] * q / x[AIRSPEED, m]
                # The air may move from the first step on, though all was steady before.
                x[VANE_OUT, m] = (x[VANE_DECAY, m] * (x[VANE_OUT, m] - x[VANE_BEFORE, m]) + vane
                                  - x[VANE_RAMP, m] * (vane - x[VANE_BEFORE, m]))  # fmt: skip
                x[VANE_BEFORE, m] = vane
                shown = max(x[SHOWN, m], x[VANE_OUT, m] - x[AT.vane_play_rad, m])
                x[SHOWN, m] = min(shown, x[VANE_OUT, m] + x[AT.vane_play_rad, m])
                turned = min(max(x[SHOWN, m] - alpha_trim, x[LOWEST, m]), x[HIGHEST, m])
                bent = (x[AT.alpha_read2, m] + x[AT.alpha_read3, m] * turned) * turned
                out[k, i, READ.alpha, m] = alpha_trim + (1.0 + x[AT.alpha_scale, m] + bent) * turned
                a_z = (x[AIRSPEED, m] * x[NORMAL_0, m] + a_x * x[SIN_ALPHA, m]) / x[COS_ALPHA, m]
                a_z -= x[AT.imu_arm_m, m] * x[QDOT_0, m]
                pulled = a_z + GRAVITY_M_S2
                out[k, i, READ.q, m] = ((1.0 + x[AT.q_scale, m]) * q + x[AT.q_bias, m]
                                   + x[AT.mode_gain, m] * x[BEND, m]
                                   + x[AT.mode_rate_gain, m] * x[BEND_RATE, m] * x[SOFTNESS, m]
                                   + (x[AT.q_pull, m] + x[AT.q_pull2, m] * pulled) * pulled)  # fmt: skip
                bent = (x[AT.a_z_read2, m] + x[AT.a_z_read3, m] * pulled) * pulled
                out[k, i, READ.a_z, m] = (1.0 + x[AT.a_z_scale, m]) * a_z + bent * pulled
                # The slope of the bent structure, which is what the gyro's part of its rate adds up to.
                slope = x[AT.mode_attitude, m] * x[AT.mode_rate_gain, m] * x[BEND, m] * x[SOFTNESS, m]
                out[k, i, READ.theta, m] = (
                    theta_from + (1.0 + x[AT.theta_scale, m]) * (theta - theta_from) + slope
                )
                # A search may try an unstable aircraft: its motion stays finite, and is rejected by its cost.
                x[ALPHA, m] = min(max(alpha + h * x[KA, m], -1.5), 1.5)
                x[Q, m] = min(max(q + h * x[KQ, m], -15.0), 15.0)
                x[THETA, m] = theta + h * (0.5 * (q + x[Q, m]) * cb - turning)
                keep = x[LIFT_DECAY, m]
                x[LIFT, m] = keep * x[LIFT, m] + (1.0 - keep) * (0.5 * (alpha + x[ALPHA, m]) + air)
                followed = max(x[FOLLOWED, m], x[ALPHA, m] + air - x[AT.memory_rad, m])
                x[FOLLOWED, m] = min(followed, x[ALPHA, m] + air + x[AT.memory_rad, m])
                if separates:
                    before, now = alpha + air - alpha_trim, x[ALPHA, m] + air - alpha_trim
                    _separate(x, m, before, now)
                off, rate, zeta = x[BEND, m] - d, x[BEND_RATE, m], x[AT.mode_damping, m]
                swing, turn, fade = x[SWING_COS, m], x[SWING_SIN, m], x[FADE, m]
                x[BEND, m] = d + fade * ((swing + zeta * turn) * off + turn * rate * x[SOFTNESS, m])
                x[BEND_RATE, m] = fade * ((swing - zeta * turn) * rate - x[AT.mode_rad_s, m] * turn * off)
    return out
