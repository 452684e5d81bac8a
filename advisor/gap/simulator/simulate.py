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

from advisor.flight.messages import FloatArray
from advisor.gap.simulator.circle import cos_sin
from advisor.gap.simulator.layout import (
    A_X,
    ALPHA_TRIM,
    BANK,
    DISTURB_AIR,
    DISTURB_FORCE,
    DISTURB_INPUT,
    DISTURB_MOMENT,
    ENTRIES,
    HEIGHT,
    REFERENCE,
    SCALED,
    SPEED,
    THETA_FROM,
    THROTTLE,
    THRUST,
    TURN,
)  # fmt: skip
from advisor.gravity import GRAVITY_M_S2
from compiled import kernel

LANES = 8
"""Simulations in a pack: the numbers in the widest registers."""
_ANYWHERE = 9.0
"""Angle of a vane without stops, rad."""
(
    Z_ALPHA, Z_Q, Z_DELTA, M_ALPHA, M_Q, M_DELTA, ALPHA_START, Q_START, Z_TRIM, M_TRIM,
    DELAY, LATENCY, LAG, LAG_DAMPING, SLOWNESS, PLAY, PLAY_SIDE, DEADBAND, NEUTRAL, STOP_UP, STOP_DOWN,
    BREAKAWAY, SLIDING, LOOP,
    M_DELTA2, M_DELTA3, M_ALPHA2, M_ALPHA3, M_ALPHA_DOT, M_H, M_THROTTLE, ENGINE_LAG, M_THRUST, WASHED, BLOWN,
    M_Q_ABS, M_Q_Q, M_ALPHA_Q, M_ALPHA_DELTA,
    Z_ALPHA2, Z_ALPHA3, STALL, SHARPNESS, LIFT_SHARE, LIFT_LAG, MOMENT_SHARE, Z_MEMORY, MEMORY,
    Z_SEPARATED, SEPARATION, ATTACHMENT, Z_H, LIFT_H, SCALE_H, SPEED_POWER, MOMENT_POWER,
    ALPHA_LAG, ALPHA_SCALE, VANE_ARM, Q_BIAS, Q_SCALE,
    MODE_GAIN, MODE_RATE_GAIN, MODE_RAD_S, MODE_DAMPING, IMU_ARM,
    ALPHA_SKEW, Q_SKEW, A_Z_SKEW, THETA_SKEW, A_Z_SCALE, THETA_SCALE,
    A_Z_READ2, A_Z_READ3, ALPHA_READ2, ALPHA_READ3, Q_PULL, Q_PULL2,
    SPEED_LEVEL, SPEED_SLOPE, SPEED_BOW, SPEED_SCALE,
    FILTER_LAG, FILTER_SHAPE, FILTER_OUTPUT, VANE_PLAY, VANE_STOP_UP, VANE_STOP_DOWN,
    MODE_ATTITUDE,
) = range(len(ENTRIES))  # fmt: skip
# Rows of a pack behind the driving numbers: what follows from them once, the state, what a step hands on.
(
    DOSE, ENGINE_DECAY, LIFT_DECAY, VANE_DECAY, VANE_RAMP, FADE, SWING_COS, SWING_SIN, SOFTNESS,
    ALPHA, Q, THETA, ENGINE, LIFT, FOLLOWED, VANE_BEFORE, VANE_OUT, SHOWN,
    HIGHEST, LOWEST, SEPARATED, MISSING, BEND, BEND_RATE,
    AIRSPEED, RATIO, NEAR, POWER, TURNING, ATTACHED, COS_ALPHA, SIN_ALPHA, GRAVITY, LIFTING, MOMENT_SLOPE,
    DEFLECTION, Z_REST, M_REST, KA, KQ, NORMAL_0, QDOT_0, ROWS,
) = range(len(ENTRIES), len(ENTRIES) + 43)  # fmt: skip


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
    if x[SEPARATED, m] == 0.0 and now > x[SEPARATION, m]:
        late = (now - x[SEPARATION, m]) / max(now - before, 1e-9)
        x[SEPARATED, m], x[MISSING, m] = 1.0, 1.0 + min(late, 1.0)
    elif x[SEPARATED, m] == 1.0 and now < x[ATTACHMENT, m]:
        late = (x[ATTACHMENT, m] - now) / max(before - now, 1e-9)
        x[SEPARATED, m], x[MISSING, m] = 0.0, -min(late, 1.0)


@kernel(error_model="numpy")
def _begin(
    x: FloatArray, lane: int, p: FloatArray, dose: float, h: float, speed: float, trim: FloatArray
) -> None:
    """Fill a lane of a pack with its driving numbers, what follows from them, and the state at the start."""
    x[: len(p), lane] = p
    x[DOSE, lane] = dose
    x[ENGINE_DECAY, lane] = np.exp(-h / max(p[ENGINE_LAG], 1e-3 * h))
    x[LIFT_DECAY, lane] = np.exp(-h / max(p[LIFT_LAG], 0.2 * h))
    # First order in the lag, so that the sensitivity to a lag exists at no lag at all.
    tau = p[ALPHA_LAG]
    decay = np.exp(-h / tau) if tau > 1e-6 else 0.0
    x[VANE_DECAY, lane], x[VANE_RAMP, lane] = decay, (tau / h) * (1.0 - decay)
    # The mode is solved exactly: it is fast beside the step. ``SWING_SIN`` is sin(ω_d h) ω/ω_d.
    omega, zeta = p[MODE_RAD_S], p[MODE_DAMPING]
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    x[FADE, lane] = np.exp(-zeta * omega * h)
    x[SWING_COS, lane] = np.cos(omega * damped * h)
    x[SWING_SIN, lane] = np.sin(omega * damped * h) / damped
    x[SOFTNESS, lane] = 1.0 / omega if omega > 0.0 else 0.0
    x[ALPHA, lane], x[Q, lane], x[THETA, lane] = (
        trim[ALPHA_TRIM] + p[ALPHA_START],
        p[Q_START],
        trim[THETA_FROM],
    )
    x[ENGINE, lane], x[LIFT, lane], x[FOLLOWED, lane] = 0.0, trim[ALPHA_TRIM], x[ALPHA, lane]
    x[VANE_OUT, lane] = x[ALPHA, lane] - p[VANE_ARM] * x[Q, lane] / speed
    x[VANE_BEFORE, lane] = x[VANE_OUT, lane]
    x[SHOWN, lane] = x[VANE_OUT, lane]
    x[SEPARATED, lane], x[MISSING, lane] = 0.0, 0.0
    up, down = p[VANE_STOP_UP], p[VANE_STOP_DOWN]
    x[HIGHEST, lane] = up if up > 0.0 else _ANYWHERE
    x[LOWEST, lane] = -down if down > 0.0 else -_ANYWHERE
    x[BEND, lane], x[BEND_RATE, lane] = 0.0, 0.0
    x[NEAR, lane], x[POWER, lane], x[TURNING, lane], x[ATTACHED, lane] = 0.0, 1.0, 1.0, 1.0


@kernel(error_model="numpy", fastmath={"contract"})
def simulate(
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
        Shape (k, entries). Parameters of each simulation in the order of ``layout.ENTRIES``.

    Returns
    -------
    Shape (packs, n + 1, 4, LANES): α and q as their sensors read them, a_z at the accelerometer, θ; of
    simulation j in lane j % LANES of pack j // LANES. Lanes to spare repeat the last.
    """
    # As many as LANES, but known only at run time: else the lanes are unrolled one after the other.
    packs, n, lanes = delta.shape
    out = np.empty((packs, n + 1, 4, LANES))
    x = np.empty((ROWS, LANES))
    alpha_trim, theta_from, reference = trim[ALPHA_TRIM], trim[THETA_FROM], trim[REFERENCE]
    scaled = trim[SCALED] > 0.5
    disturbed = disturbance.shape[1] == n
    level = np.cos(slow[BANK])
    d_delta, d_force, d_moment, d_air = 0.0, 0.0, 0.0, 0.0
    for k in range(packs):
        low, stalls, other_power, separates = False, False, False, False
        for m in range(LANES):
            j = min(k * LANES + m, len(p) - 1)
            _begin(x, m, p[j], doses[j], h, slow[SPEED, 0], trim)
            low, stalls = low or p[j, SCALE_H] > 0.0, stalls or p[j, SHARPNESS] > 0.0
            other_power = other_power or p[j, SPEED_POWER] != 0.0 or p[j, MOMENT_POWER] != 0.0
            separates = separates or p[j, SEPARATION] != 0.0
        for i in range(n + 1):
            j = min(i, n - 1)
            a_x, cb, turning = slow[A_X, j], level[j], slow[TURN, j]
            along = 2.0 * j / n - 1.0
            for m in range(lanes):
                off = x[SPEED_LEVEL, m] + along * (x[SPEED_SLOPE, m] + along * x[SPEED_BOW, m])
                # Derivatives are given at the speed as it is read; what bends the path is the true one.
                x[AIRSPEED, m] = (slow[SPEED, j] + off) * (1.0 + x[SPEED_SCALE, m])
                x[RATIO, m] = (slow[SPEED, j] + off) / reference if scaled else 1.0
            if disturbed:
                d_delta, d_force = disturbance[DISTURB_INPUT, j], disturbance[DISTURB_FORCE, j]
                d_moment, d_air = disturbance[DISTURB_MOMENT, j], disturbance[DISTURB_AIR, j]
            if other_power:
                for m in range(lanes):
                    x[POWER, m] = x[RATIO, m] ** x[SPEED_POWER, m]
                    x[TURNING, m] = x[POWER, m] * x[RATIO, m] ** x[MOMENT_POWER, m]
            if low:
                scale, near = 0.0, 0.0
                for m in range(lanes):
                    if x[SCALE_H, m] != scale:
                        scale = x[SCALE_H, m]
                        # Heights count from a place that may lie above the ground; a trial scale may be tiny.
                        near = np.exp(min(-slow[HEIGHT, j] / max(scale, 1e-3), 3.0)) if scale > 0.0 else 0.0
                    x[NEAR, m] = near
            for m in range(lanes):
                d = delta[k, j, m] + x[DOSE, m] * d_delta
                v = x[RATIO, m]
                vv = v * v
                z_d = x[Z_DELTA, m]
                met = vv + x[WASHED, m] * (1.0 - vv) + x[BLOWN, m] * slow[THRUST, j]
                m_d = x[M_DELTA, m] * x[TURNING, m] * met
                pressure = x[TURNING, m] * vv
                lifting = x[POWER, m] * v * (1.0 + x[LIFT_H, m] * x[NEAR, m])
                ca, sa = cos_sin(x[ALPHA, m])
                ct, st = cos_sin(x[THETA, m])
                x[COS_ALPHA, m], x[SIN_ALPHA, m] = ca, sa
                x[GRAVITY, m] = GRAVITY_M_S2 / x[AIRSPEED, m] * (ca * ct * cb + sa * st)
                x[LIFTING, m] = lifting
                x[ENGINE, m] = slow[THROTTLE, j] + x[ENGINE_DECAY, m] * (x[ENGINE, m] - slow[THROTTLE, j])
                x[MOMENT_SLOPE, m] = pressure * x[M_ALPHA, m]
                x[DEFLECTION, m] = d
                x[Z_REST, m] = v * x[Z_H, m] * x[NEAR, m] + x[DOSE, m] * d_force + lifting * z_d * d
                x[M_REST, m] = (
                    m_d * d
                    + pressure * (x[M_TRIM, m] + (x[M_DELTA2, m] + x[M_DELTA3, m] * d) * d * d)
                    + pressure * x[M_H, m] * x[NEAR, m] + x[M_THROTTLE, m] * x[ENGINE, m]
                    + x[M_THRUST, m] * (1.0 - vv) + x[DOSE, m] * d_moment
                )  # fmt: skip
                # Outputs belong to the start of the step.
                ahead = above[k, j, m]
                x[NORMAL_0, m], x[QDOT_0, m] = -lifting * z_d * ahead, -m_d * ahead
                x[KA, m], x[KQ, m] = 0.0, 0.0
            # The midpoint rule: at a hundredth of the period a step its error is far below any derivative's.
            for stage in range(2):
                if stalls:
                    for m in range(lanes):
                        if x[SHARPNESS, m] > 0.0:
                            a = x[ALPHA, m] + 0.5 * h * x[KA, m] + x[DOSE, m] * d_air
                            x[ATTACHED, m] = _attached(x[SHARPNESS, m] * (a - x[STALL, m]))
                for m in range(lanes):
                    a = x[ALPHA, m] + 0.5 * h * x[KA, m] + x[DOSE, m] * d_air
                    q = x[Q, m] + 0.5 * h * x[KQ, m]
                    da = a - alpha_trim
                    behind = a - x[LIFT, m]
                    lagged, turned = da - x[LIFT_SHARE, m] * behind, da - x[MOMENT_SHARE, m] * behind
                    wing = (
                        x[Z_TRIM, m]
                        + (x[Z_ALPHA, m] + (x[Z_ALPHA2, m] + x[Z_ALPHA3, m] * lagged) * lagged) * lagged
                    )
                    wing += x[Z_MEMORY, m] * (a - x[FOLLOWED, m]) + x[Z_SEPARATED, m] * x[MISSING, m]
                    normal = x[Z_REST, m] + x[LIFTING, m] * x[ATTACHED, m] * wing + x[Z_Q, m] * q
                    ka = q + x[GRAVITY, m] + normal
                    v = x[RATIO, m]
                    bent = (x[M_ALPHA2, m] + x[M_ALPHA3, m] * da) * da
                    bent += x[M_ALPHA_DELTA, m] * x[DEFLECTION, m]
                    slope = x[MOMENT_SLOPE, m] + x[TURNING, m] * v * v * bent
                    damping = x[M_Q, m] + x[M_ALPHA_Q, m] * da + x[M_Q_Q, m] * abs(q)
                    damped = damping * q + x[M_Q_ABS, m] * abs(q)
                    kq = x[M_REST, m] + slope * turned + v * (damped + x[M_ALPHA_DOT, m] * ka)
                    x[KA, m], x[KQ, m] = ka, kq
                    if stage == 0:
                        x[NORMAL_0, m] += normal
                        x[QDOT_0, m] += kq
            for m in range(lanes):
                alpha, q, theta, d = x[ALPHA, m], x[Q, m], x[THETA, m], x[DEFLECTION, m]
                air = x[DOSE, m] * d_air
                vane = alpha + air - x[VANE_ARM, m] * q / x[AIRSPEED, m]
                # The air may move from the first step on, though all was steady before.
                x[VANE_OUT, m] = (x[VANE_DECAY, m] * (x[VANE_OUT, m] - x[VANE_BEFORE, m]) + vane
                                  - x[VANE_RAMP, m] * (vane - x[VANE_BEFORE, m]))  # fmt: skip
                x[VANE_BEFORE, m] = vane
                shown = max(x[SHOWN, m], x[VANE_OUT, m] - x[VANE_PLAY, m])
                x[SHOWN, m] = min(shown, x[VANE_OUT, m] + x[VANE_PLAY, m])
                turned = min(max(x[SHOWN, m] - alpha_trim, x[LOWEST, m]), x[HIGHEST, m])
                bent = (x[ALPHA_READ2, m] + x[ALPHA_READ3, m] * turned) * turned
                out[k, i, 0, m] = alpha_trim + (1.0 + x[ALPHA_SCALE, m] + bent) * turned
                a_z = (x[AIRSPEED, m] * x[NORMAL_0, m] + a_x * x[SIN_ALPHA, m]) / x[COS_ALPHA, m]
                a_z -= x[IMU_ARM, m] * x[QDOT_0, m]
                pulled = a_z + GRAVITY_M_S2
                out[k, i, 1, m] = ((1.0 + x[Q_SCALE, m]) * q + x[Q_BIAS, m] + x[MODE_GAIN, m] * x[BEND, m]
                                   + x[MODE_RATE_GAIN, m] * x[BEND_RATE, m] * x[SOFTNESS, m]
                                   + (x[Q_PULL, m] + x[Q_PULL2, m] * pulled) * pulled)  # fmt: skip
                bent = (x[A_Z_READ2, m] + x[A_Z_READ3, m] * pulled) * pulled
                out[k, i, 2, m] = (1.0 + x[A_Z_SCALE, m]) * a_z + bent * pulled
                # The slope of the bent structure, which is what the gyro's part of its rate adds up to.
                slope = x[MODE_ATTITUDE, m] * x[MODE_RATE_GAIN, m] * x[BEND, m] * x[SOFTNESS, m]
                out[k, i, 3, m] = theta_from + (1.0 + x[THETA_SCALE, m]) * (theta - theta_from) + slope
                # A search may try an unstable aircraft: its motion stays finite, and is rejected by its cost.
                x[ALPHA, m] = min(max(alpha + h * x[KA, m], -1.5), 1.5)
                x[Q, m] = min(max(q + h * x[KQ, m], -15.0), 15.0)
                x[THETA, m] = theta + h * (0.5 * (q + x[Q, m]) * cb - turning)
                keep = x[LIFT_DECAY, m]
                x[LIFT, m] = keep * x[LIFT, m] + (1.0 - keep) * (0.5 * (alpha + x[ALPHA, m]) + air)
                followed = max(x[FOLLOWED, m], x[ALPHA, m] + air - x[MEMORY, m])
                x[FOLLOWED, m] = min(followed, x[ALPHA, m] + air + x[MEMORY, m])
                if separates:
                    before, now = alpha + air - alpha_trim, x[ALPHA, m] + air - alpha_trim
                    _separate(x, m, before, now)
                off, rate, zeta = x[BEND, m] - d, x[BEND_RATE, m], x[MODE_DAMPING, m]
                swing, turn, fade = x[SWING_COS, m], x[SWING_SIN, m], x[FADE, m]
                x[BEND, m] = d + fade * ((swing + zeta * turn) * off + turn * rate * x[SOFTNESS, m])
                x[BEND_RATE, m] = fade * ((swing - zeta * turn) * rate - x[MODE_RAD_S, m] * turn * off)
    return out
