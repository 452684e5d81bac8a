"""The parts of one step of the simulation, each for all lanes of a pack (``advisor.gap.simulator.pack``).

The argument ``lanes`` always equals ``LANES``. The number is hidden from the compiler, which would otherwise
unroll the loops lane by lane.
"""

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.simulator import pack as row
from advisor.gap.simulator.circle import cos_sin
from advisor.gap.simulator.layout import AT, READ, SLOW, TRIM
from advisor.process.arrays import FloatArray
from advisor.process.compiled import kernel

_inlined = kernel(error_model="numpy", fastmath={"contract"}, inline="always")
"""Decorator of a part of a step. As calls, not inlined, the parts take over four times as long."""


@kernel()
def _attached(beyond: float) -> float:
    """Return the attached share of the lift; Kirchhoff's flow is separated over half the chord at 0."""
    chord = 1.0 / (1.0 + np.exp(2.0 * beyond))
    return float(0.25 * (1.0 + np.sqrt(chord)) ** 2)


@kernel(error_model="numpy")
def _separate(x: FloatArray, m: int, before: float, now: float) -> None:
    """Separate the flow above one angle and attach it again below another, with the memory of a relay.

    The angle is met within a step; the next step corrects the part that was missed.
    """
    x[row.MISSING, m] = x[row.SEPARATED, m]
    if x[row.SEPARATED, m] == 0.0 and now > x[AT.separation_rad, m]:
        late = (now - x[AT.separation_rad, m]) / max(now - before, 1e-9)
        x[row.SEPARATED, m], x[row.MISSING, m] = 1.0, 1.0 + min(late, 1.0)
    elif x[row.SEPARATED, m] == 1.0 and now < x[AT.attachment_rad, m]:
        late = (x[AT.attachment_rad, m] - now) / max(before - now, 1e-9)
        x[row.SEPARATED, m], x[row.MISSING, m] = 0.0, -min(late, 1.0)


@_inlined
def take_speed(
    x: FloatArray, lanes: int, speed: float, along: float, reference: float, scaled: bool, powers: bool
) -> None:
    """Write air speed, its ratio to the reference speed, and the powers of that ratio.

    Parameters
    ----------
    speed
        Air speed as read, m/s.
    along
        Normalised time in the record, -1 at its start and 1 at its end.
    scaled
        Whether derivatives scale with the air speed.
    powers
        Whether any lane has forces or moments that do not grow with V².
    """
    for m in range(lanes):
        bowed = x[AT.speed_slope_m_s, m] + along * x[AT.speed_bow_m_s, m]
        off = x[AT.speed_level_m_s, m] + along * bowed
        # Derivatives are given at the speed as it is read; the true speed bends the path.
        x[row.AIRSPEED, m] = (speed + off) * (1.0 + x[AT.speed_scale, m])
        x[row.RATIO, m] = (speed + off) / reference if scaled else 1.0
    if powers:
        for m in range(lanes):
            x[row.POWER, m] = x[row.RATIO, m] ** x[AT.speed_power, m]
            x[row.TURNING, m] = x[row.POWER, m] * x[row.RATIO, m] ** x[AT.moment_power, m]


@_inlined
def near_ground(x: FloatArray, lanes: int, height: float) -> None:
    """Write the ground proximity e^(−h/b) at a height h in m; 0 in lanes without ground effect."""
    scale, near = 0.0, 0.0
    for m in range(lanes):
        if x[AT.scale_m, m] != scale:
            scale = x[AT.scale_m, m]
            # Heights count from a place that may lie above the ground, and a trial scale may be tiny.
            near = np.exp(min(-height / max(scale, 1e-3), 3.0)) if scale > 0.0 else 0.0
        x[row.NEAR, m] = near


@_inlined
def hold_over_step(
    x: FloatArray, lanes: int, delta: FloatArray, above: FloatArray, slow: FloatArray, level: float,
    disturbed: tuple[float, float, float],
) -> None:  # fmt: skip
    """Write the values that stay constant over a step: gravity, forces and moments free of the state.

    Parameters
    ----------
    delta, above
        Shape (LANES,): mean deflection over the step relative to trim, and that minus the one at its start.
    slow
        Shape (10,): the slow inputs of the step.
    level
        Cosine of the bank.
    disturbed
        Disturbances of δ (rad), α̇ (rad/s) and q̇ (rad/s²), for a scale of 1 (entry ``DOSE``).
    """
    throttle, thrust = slow[SLOW.throttle], slow[SLOW.thrust]
    d_delta, d_force, d_moment = disturbed
    for m in range(lanes):
        d = delta[m] + x[row.DOSE, m] * d_delta
        v = x[row.RATIO, m]
        vv = v * v
        z_d = x[AT.Z_delta_e, m]
        met = vv + x[AT.washed_share, m] * (1.0 - vv) + x[AT.blown_share, m] * thrust
        m_d = x[AT.M_delta_e, m] * x[row.TURNING, m] * met
        pressure = x[row.TURNING, m] * vv
        lifting = x[row.POWER, m] * v * (1.0 + x[AT.lift_h, m] * x[row.NEAR, m])
        ca, sa = cos_sin(x[row.ALPHA, m])
        ct, st = cos_sin(x[row.THETA, m])
        x[row.COS_ALPHA, m], x[row.SIN_ALPHA, m] = ca, sa
        x[row.GRAVITY, m] = GRAVITY_M_S2 / x[row.AIRSPEED, m] * (ca * ct * level + sa * st) + slow[SLOW.slip]
        x[row.LIFTING, m] = lifting
        x[row.ENGINE, m] = throttle + x[row.ENGINE_DECAY, m] * (x[row.ENGINE, m] - throttle)
        x[row.MOMENT_SLOPE, m] = pressure * x[AT.M_alpha, m]
        x[row.DEFLECTION, m] = d
        x[row.Z_REST, m] = v * x[AT.Z_h, m] * x[row.NEAR, m] + x[row.DOSE, m] * d_force + lifting * z_d * d
        x[row.M_REST, m] = (
            m_d * d
            + pressure * (x[AT.M_trim, m] + (x[AT.M_delta2, m] + x[AT.M_delta3, m] * d) * d * d)
            + pressure * x[AT.M_h, m] * x[row.NEAR, m] + x[AT.M_throttle, m] * x[row.ENGINE, m]
            + x[AT.M_thrust, m] * (1.0 - vv) + x[AT.inertia_share, m] * slow[SLOW.roll_yaw]
            + x[AT.inertia_product, m] * slow[SLOW.squares] + x[row.DOSE, m] * d_moment
        )  # fmt: skip
        # Outputs belong to the start of the step.
        ahead = above[m]
        x[row.NORMAL_0, m], x[row.QDOT_0, m] = -lifting * z_d * ahead, -m_d * ahead
        x[row.KA, m], x[row.KQ, m] = 0.0, 0.0


@_inlined
def stall(x: FloatArray, lanes: int, h: float, d_air: float) -> None:
    """Write the attached share of the lift, half a step of ``h`` s ahead of the state."""
    for m in range(lanes):
        if x[AT.stall_sharpness, m] > 0.0:
            a = x[row.ALPHA, m] + 0.5 * h * x[row.KA, m] + x[row.DOSE, m] * d_air
            x[row.ATTACHED, m] = _attached(x[AT.stall_sharpness, m] * (a - x[AT.stall_rad, m]))


@_inlined
def normal_force(x: FloatArray, m: int, a: float, q: float, da: float, behind: float) -> float:
    """Return the normal force over m·V in rad/s: Eq. (1) without its kinematics.

    Parameters
    ----------
    a, q
        Angle of attack (rad) and pitch rate (rad/s).
    da, behind
        Angle of attack relative to trim, and relative to the lagging one, rad.
    """
    lagged = da - x[AT.lift_share, m] * behind
    wing = (
        x[AT.Z_trim, m]
        + (x[AT.Z_alpha, m] + (x[AT.Z_alpha2, m] + x[AT.Z_alpha3, m] * lagged) * lagged) * lagged
    )
    wing += x[AT.Z_memory, m] * (a - x[row.FOLLOWED, m]) + x[AT.Z_separated, m] * x[row.MISSING, m]
    turned = (x[AT.Z_q, m] + x[AT.Z_q_q, m] * abs(q)) * q + x[AT.Z_q_abs, m] * abs(q)
    normal: float = x[row.Z_REST, m] + x[row.LIFTING, m] * x[row.ATTACHED, m] * wing + turned
    return normal


@_inlined
def moment(x: FloatArray, m: int, q: float, alpha_dot: float, da: float, behind: float) -> float:
    """Return the pitch acceleration in rad/s²: Eq. (2). The other arguments are those of ``normal_force``."""
    turned = da - x[AT.moment_share, m] * behind
    v = x[row.RATIO, m]
    bent = (x[AT.M_alpha2, m] + x[AT.M_alpha3, m] * da) * da
    bent += x[AT.M_alpha_delta_e, m] * x[row.DEFLECTION, m]
    slope = x[row.MOMENT_SLOPE, m] + x[row.TURNING, m] * v * v * bent
    damping = x[AT.M_q, m] + x[AT.M_alpha_q, m] * da + x[AT.M_q_q, m] * abs(q)
    damped = damping * q + x[AT.M_q_abs, m] * abs(q)
    pitching: float = x[row.M_REST, m] + slope * turned + v * (damped + x[AT.M_alpha_dot, m] * alpha_dot)
    return pitching


@_inlined
def rates(x: FloatArray, lanes: int, h: float, d_air: float, alpha_trim: float, first: bool) -> None:
    """Write α̇ and q̇ by Eqs. (1)-(2), half a step ahead of the state by the rates known so far.

    ``first``: the rates of the previous step count as zero, so the result belongs to the step's start, like
    the outputs.
    """
    for m in range(lanes):
        a = x[row.ALPHA, m] + 0.5 * h * x[row.KA, m] + x[row.DOSE, m] * d_air
        q = x[row.Q, m] + 0.5 * h * x[row.KQ, m]
        da = a - alpha_trim
        behind = a - x[row.LIFT, m]
        normal = normal_force(x, m, a, q, da, behind)
        ka = q + x[row.GRAVITY, m] + normal
        kq = moment(x, m, q, ka, da, behind)
        x[row.KA, m], x[row.KQ, m] = ka, kq
        if first:
            x[row.NORMAL_0, m] += normal
            x[row.QDOT_0, m] += kq


@_inlined
def read_sensors(
    x: FloatArray, lanes: int, out: FloatArray, d_air: float, slow: FloatArray, trim: FloatArray
) -> None:
    """Write the instrument readings at the start of a step into ``out``, shape (4, LANES)."""
    a_x, alpha_trim, theta_from = slow[SLOW.a_x], trim[TRIM.alpha], trim[TRIM.theta]
    for m in range(lanes):
        alpha, q, air = x[row.ALPHA, m], x[row.Q, m], x[row.DOSE, m] * d_air
        x[row.AIR, m] = air
        vane = alpha + air - x[AT.vane_arm_m, m] * q / x[row.AIRSPEED, m]
        # The air may move after the first step, although the vane was steady at the start.
        x[row.VANE_OUT, m] = (x[row.VANE_DECAY, m] * (x[row.VANE_OUT, m] - x[row.VANE_BEFORE, m]) + vane
                          - x[row.VANE_RAMP, m] * (vane - x[row.VANE_BEFORE, m]))  # fmt: skip
        x[row.VANE_BEFORE, m] = vane
        shown = max(x[row.SHOWN, m], x[row.VANE_OUT, m] - x[AT.vane_play_rad, m])
        x[row.SHOWN, m] = min(shown, x[row.VANE_OUT, m] + x[AT.vane_play_rad, m])
        turned = min(max(x[row.SHOWN, m] - alpha_trim, x[row.LOWEST, m]), x[row.HIGHEST, m])
        bent = (x[AT.alpha_read2, m] + x[AT.alpha_read3, m] * turned) * turned
        out[READ.alpha, m] = alpha_trim + (1.0 + x[AT.alpha_scale, m] + bent) * turned
        a_z = (x[row.AIRSPEED, m] * x[row.NORMAL_0, m] + a_x * x[row.SIN_ALPHA, m]) / x[row.COS_ALPHA, m]
        a_z -= x[AT.imu_arm_m, m] * (x[row.QDOT_0, m] - slow[SLOW.roll_yaw])
        pulled = a_z + GRAVITY_M_S2
        out[READ.q, m] = ((1.0 + x[AT.q_scale, m]) * q + x[AT.q_bias, m]
                          + x[AT.mode_gain, m] * x[row.BEND, m]
                          + x[AT.mode_rate_gain, m] * x[row.BEND_RATE, m] * x[row.SOFTNESS, m]
                          + (x[AT.q_pull, m] + x[AT.q_pull2, m] * pulled) * pulled)  # fmt: skip
        bent = (x[AT.a_z_read2, m] + x[AT.a_z_read3, m] * pulled) * pulled
        out[READ.a_z, m] = (1.0 + x[AT.a_z_scale, m]) * a_z + bent * pulled
        # The slope of the bent structure is the integral of the gyro's part of its rate.
        slope = x[AT.mode_attitude, m] * x[AT.mode_rate_gain, m] * x[row.BEND, m] * x[row.SOFTNESS, m]
        out[READ.theta, m] = (
            theta_from + (1.0 + x[AT.theta_scale, m]) * (x[row.THETA, m] - theta_from) + slope
        )


@_inlined
def advance(
    x: FloatArray, lanes: int, h: float, alpha_trim: float, level: float, turning: float, separates: bool
) -> None:
    """Advance the state over a step of ``h`` s: motion, lift with a lag or a memory, structural mode.

    Parameters
    ----------
    level, turning
        Cosine of the bank, and r sin φ in rad/s, which a turn subtracts from θ̇.
    separates
        Whether the flow may separate in any lane.
    """
    for m in range(lanes):
        alpha, q, theta = x[row.ALPHA, m], x[row.Q, m], x[row.THETA, m]
        air, d = x[row.AIR, m], x[row.DEFLECTION, m]
        # A search may try an unstable aircraft: the clipped motion stays finite, and its cost rejects it.
        x[row.ALPHA, m] = min(max(alpha + h * x[row.KA, m], -1.5), 1.5)
        x[row.Q, m] = min(max(q + h * x[row.KQ, m], -15.0), 15.0)
        x[row.THETA, m] = theta + h * (0.5 * (q + x[row.Q, m]) * level - turning)
        keep = x[row.LIFT_DECAY, m]
        x[row.LIFT, m] = keep * x[row.LIFT, m] + (1.0 - keep) * (0.5 * (alpha + x[row.ALPHA, m]) + air)
        followed = max(x[row.FOLLOWED, m], x[row.ALPHA, m] + air - x[AT.memory_rad, m])
        x[row.FOLLOWED, m] = min(followed, x[row.ALPHA, m] + air + x[AT.memory_rad, m])
        if separates:
            before, now = alpha + air - alpha_trim, x[row.ALPHA, m] + air - alpha_trim
            _separate(x, m, before, now)
        off, rate, zeta = x[row.BEND, m] - d, x[row.BEND_RATE, m], x[AT.mode_damping, m]
        swing, turn, fade = x[row.SWING_COS, m], x[row.SWING_SIN, m], x[row.FADE, m]
        x[row.BEND, m] = d + fade * ((swing + zeta * turn) * off + turn * rate * x[row.SOFTNESS, m])
        x[row.BEND_RATE, m] = fade * ((swing - zeta * turn) * rate - x[AT.mode_rad_s, m] * turn * off)
