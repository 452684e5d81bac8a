"""The simulator under diagnosis: short-period motion at a measured air speed, with every effect in it.

Eqs. (1)-(2) about the trim of each manoeuvre, with the exact kinematics of the accelerometer and
the attitude and, where the speed is measured, derivatives that scale with it. The low-order terms
of the candidate effects are in the same loop, each switched off by a zero (``advisor.gap.layout``).

    v = V/V_r,  Δα = α − α_trim,  Δδ = δ − δ_trim
    N  = v (1 + k_h e^(−h/b)) (Z_trim + Z_α Δα_e + Z_δe Δδ + ...) + Z_q q       normal force over m·V
    α̇ = q + G + N,   G = (g/V)(cos α cos θ cos φ + sin α sin θ)
    q̇ = v² (M_trim + M_α Δα + M_δe Δδ + ...) + v (M_q q + M_α̇ α̇) + M_T ΔT + M_P (1 − v²)
    θ̇ = q cos φ,   a_z cos α = V N + a_x sin α

Where forces do not go with V², lift and all moments of α and δ are multiplied by v^n besides.
The last is the exact a_z = V cos α (α̇ − q) + V̇ sin α − g cos θ with V̇ replaced by what a_x measures.
"""

import numpy as np
from numba import njit

from advisor.flight.messages import FloatArray
from advisor.gap.layout import INDEX

GRAVITY_M_S2 = 9.80665
_I = tuple(INDEX[name] for name in INDEX)
(
    Z_ALPHA, Z_Q, Z_DELTA, M_ALPHA, M_Q, M_DELTA, ALPHA_START, Q_START, Z_TRIM, M_TRIM,
    DELAY, LAG, LAG_DAMPING, SLOWNESS, PLAY, PLAY_SIDE, DEADBAND, NEUTRAL,
    M_DELTA2, M_DELTA3, M_ALPHA2, M_ALPHA3, M_ALPHA_DOT, M_H, M_THROTTLE, M_THRUST, WASHED, BLOWN,
    Z_ALPHA2, Z_ALPHA3, STALL, SHARPNESS, LIFT_SHARE, LIFT_LAG, Z_H, LIFT_H, SCALE_H, SPEED_POWER,
    STEP_AT, STEP_Z_ALPHA, STEP_Z_DELTA, STEP_M_ALPHA, STEP_M_DELTA,
    ALPHA_LAG, ALPHA_SCALE, ALPHA_BIAS, VANE_ARM, Q_BIAS, Q_SCALE,
    MODE_GAIN, MODE_RATE_GAIN, MODE_RAD_S, MODE_DAMPING, IMU_ARM,
    ALPHA_SKEW, Q_SKEW, A_Z_SKEW, THETA_SKEW, LATENCY,
) = _I  # fmt: skip
# Rows of the slow inputs, one value a step.
SPEED, A_X, BANK, THROTTLE, HEIGHT, THRUST = range(6)
# Rows of the disturbances, one value a step: added to δ, α̇, q̇ and to the angle of the air.
DISTURB_INPUT, DISTURB_FORCE, DISTURB_MOMENT, DISTURB_AIR = range(4)


@njit(cache=True)
def surface(
    h: float, n: int, t_u: FloatArray, u: FloatArray, held: bool, trim: float, p: FloatArray
) -> FloatArray:
    """Mean deflection over each step, relative to trim, after everything between stick and surface.

    The command is averaged over the step by its exact integral, so that an edge inside a step
    keeps its area and the result is smooth in the delay.
    """
    out = np.empty(n)
    k = 0
    late = p[DELAY] + p[LATENCY]
    tau, slow, play, dead = p[LAG], p[SLOWNESS], max(p[PLAY], 0.0), max(p[DEADBAND], 0.0)
    decay = np.exp(-h / tau) if tau > 1e-6 else 0.0
    # A servo of second order that trails a ramp by τ = 2 ζ/ω, solved exactly for what it is told in a step.
    zeta = p[LAG_DAMPING] if tau > 1e-3 else 0.0
    omega = 2.0 * zeta / max(tau, 1e-3)
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    fade = np.exp(-zeta * omega * h)
    swing_cos, swing_sin = np.cos(omega * damped * h), np.sin(omega * damped * h) / damped
    rate = 0.0
    servo = np.nan
    link = 0.0
    last = len(u) - 1
    for i in range(n):
        a, b = i * h - late, (i + 1) * h - late
        while k > 0 and t_u[k] > a:
            k -= 1
        total, at = 0.0, a
        if a < t_u[0]:
            upto = min(b, t_u[0])
            total += (upto - a) * u[0]
            at = upto
        while at < b - 1e-12:
            while k < last and t_u[k + 1] <= at + 1e-12:
                k += 1
            upto = b if k == last else min(b, t_u[k + 1])
            if held or k == last:
                total += (upto - at) * u[k]
            else:
                slope = (u[k + 1] - u[k]) / (t_u[k + 1] - t_u[k])
                total += (upto - at) * (u[k] + slope * (0.5 * (at + upto) - t_u[k]))
            at = upto
        want = total / h - trim
        if dead > 0.0:
            want = _beyond(want - p[NEUTRAL], dead) - _beyond(-p[NEUTRAL], dead)
        if np.isnan(servo):
            servo = want
            link = want + p[PLAY_SIDE] * play
        if omega > 0.0:
            off, before_rate = servo - want, rate
            to = want + fade * ((swing_cos + zeta * swing_sin) * off + swing_sin * rate / omega)
            rate = fade * ((swing_cos - zeta * swing_sin) * rate - omega * swing_sin * off)
            mean = 0.5 * (servo + to) + h * (before_rate - rate) / 12.0
        elif tau > 1e-6:
            to = decay * servo + (1.0 - decay) * want
            mean = want + (servo - want) * (tau / h) * (1.0 - decay)
        else:
            # First order in τ, so that the sensitivity to a lag exists at no lag at all.
            to, mean = want, want + (servo - want) * tau / h
        if slow > 0.0 and abs(to - servo) * slow > h:
            to = servo + np.sign(to - servo) * h / slow
            mean = 0.5 * (servo + to)
        servo = to
        if play > 0.0:
            before = link
            link = min(max(link, servo - play), servo + play)
            mean = 0.5 * (before + link)
        out[i] = mean
    return out


@njit(cache=True)
def _attached(beyond: float) -> float:
    """Share of the lift that is left, the flow separated over half the chord at 0 (Kirchhoff's flow)."""
    chord = 0.5 * (1.0 - np.tanh(beyond))
    return float(0.25 * (1.0 + np.sqrt(chord)) ** 2)


@njit(cache=True)
def _beyond(x: float, dead: float) -> float:
    return float(np.sign(x) * max(abs(x) - dead, 0.0))


@njit(cache=True)
def simulate(
    h: float, delta: FloatArray, slow: FloatArray, disturbance: FloatArray, trim: FloatArray, p: FloatArray
) -> FloatArray:
    """Fly one manoeuvre.

    Parameters
    ----------
    h
        Step in s.
    delta
        Shape (n,). Mean deflection over each step relative to trim, from ``surface``.
    slow
        Shape (6, n). Speed m/s, a_x m/s², bank rad, throttle relative to its start, height m, and thrust
        less drag over weight, less its mean.
    disturbance
        Shape (4, n), or (4, 0) for none: added to δ, α̇, q̇ and the angle of the air.
    trim
        Shape (4,). α, θ at the start, reference speed; and 1 when derivatives scale with speed.
    p
        Parameters in the order of ``layout.ENTRIES``.

    Returns
    -------
    Shape (4, n + 1): α as its sensor reads it, q likewise, a_z at the accelerometer, θ.
    """
    n = len(delta)
    out = np.empty((4, n + 1))
    alpha_trim, reference = trim[0], trim[2]
    scaled = trim[3] > 0.5
    disturbed = disturbance.shape[1] == n
    alpha, q, theta = alpha_trim + p[ALPHA_START], p[Q_START], trim[1]
    lift_state = alpha_trim
    lift_decay = np.exp(-h / max(p[LIFT_LAG], 0.2 * h))
    vane_tau = p[ALPHA_LAG]
    vane_decay = np.exp(-h / vane_tau) if vane_tau > 1e-6 else 0.0
    vane_before = alpha - p[VANE_ARM] * q / slow[SPEED, 0]
    vane_out = vane_before
    bend, bend_rate = 0.0, 0.0
    omega, zeta = p[MODE_RAD_S], p[MODE_DAMPING]
    # The mode is solved exactly: it is fast beside the step. ``swing_sin`` is sin(ω_d h) ω/ω_d.
    damped = np.sqrt(max(1.0 - zeta * zeta, 1e-6))
    fade = np.exp(-zeta * omega * h)
    swing_cos, swing_sin = np.cos(omega * damped * h), np.sin(omega * damped * h) / damped
    for i in range(n + 1):
        j = min(i, n - 1)
        V = slow[SPEED, j]
        v = V / reference if scaled else 1.0
        power = v ** p[SPEED_POWER] if p[SPEED_POWER] != 0.0 else 1.0
        d = delta[j]
        air, force_in, moment_in = 0.0, 0.0, 0.0
        if disturbed:
            d += disturbance[DISTURB_INPUT, j]
            force_in = disturbance[DISTURB_FORCE, j]
            moment_in = disturbance[DISTURB_MOMENT, j]
            air = disturbance[DISTURB_AIR, j]
        z_a, z_d, m_a, m_d = p[Z_ALPHA], p[Z_DELTA], p[M_ALPHA], p[M_DELTA]
        if i * h >= p[STEP_AT] and p[STEP_AT] != 0.0:
            z_a *= 1.0 + p[STEP_Z_ALPHA]
            z_d *= 1.0 + p[STEP_Z_DELTA]
            m_a *= 1.0 + p[STEP_M_ALPHA]
            m_d *= 1.0 + p[STEP_M_DELTA]
        ca, sa, ct, st = np.cos(alpha), np.sin(alpha), np.cos(theta), np.sin(theta)
        cb = np.cos(slow[BANK, j])
        gravity = GRAVITY_M_S2 / V * (ca * ct * cb + sa * st)
        near = np.exp(-slow[HEIGHT, j] / max(p[SCALE_H], 1e-3)) if p[SCALE_H] > 0.0 else 0.0
        z_c = v * p[Z_H] * near + force_in
        lifting = power * v * (1.0 + p[LIFT_H] * near)
        tail = power * (v * v + p[WASHED] * (1.0 - v * v) + p[BLOWN] * slow[THRUST, j])
        m_c = (tail * m_d * d
               + power * v * v * (p[M_TRIM] + p[M_DELTA2] * d * d + p[M_DELTA3] * d * d * d + p[M_H] * near)
               + p[M_THROTTLE] * slow[THROTTLE, j] + p[M_THRUST] * (1.0 - v * v) + moment_in)  # fmt: skip
        a0, q0 = alpha, q
        ka, kq = 0.0, 0.0
        normal_0, qdot_0 = 0.0, 0.0
        # The midpoint rule: at steps of a hundredth of the period its error is far below any derivative's.
        for stage in range(2):
            a_s, q_s = a0 + 0.5 * h * ka, q0 + 0.5 * h * kq
            da = a_s + air - alpha_trim
            lagged = da - p[LIFT_SHARE] * (a_s + air - lift_state)
            wing = p[Z_TRIM] + z_a * lagged + (p[Z_ALPHA2] + p[Z_ALPHA3] * lagged) * lagged * lagged
            if p[SHARPNESS] > 0.0:
                wing *= _attached(p[SHARPNESS] * (a_s + air - p[STALL]))
            normal = z_c + lifting * (wing + z_d * d) + p[Z_Q] * q_s
            ka = q_s + gravity + normal
            kq = (m_c + power * v * v * (m_a * da + (p[M_ALPHA2] + p[M_ALPHA3] * da) * da * da)
                  + v * (p[M_Q] * q_s + p[M_ALPHA_DOT] * ka))  # fmt: skip
            if stage == 0:
                normal_0, qdot_0 = normal, kq
        # Outputs belong to the start of the step: there the deflection lies between the means of two steps.
        ahead = 0.5 * (delta[j] - delta[max(j - 1, 0)])
        normal_0 -= lifting * z_d * ahead
        qdot_0 -= tail * m_d * ahead
        vane = alpha + air - p[VANE_ARM] * q / V
        if i > 0:
            if vane_tau > 1e-6:
                ramp = (vane_tau / h) * (1.0 - vane_decay)
                vane_out = (
                    vane_decay * vane_out + vane - vane_decay * vane_before - ramp * (vane - vane_before)
                )
            else:
                vane_out = vane - vane_tau * (vane - vane_before) / h
        vane_before = vane
        out[0, i] = (1.0 + p[ALPHA_SCALE]) * (vane_out - alpha_trim) + alpha_trim + p[ALPHA_BIAS]
        out[1, i] = (1.0 + p[Q_SCALE]) * q + p[Q_BIAS] + p[MODE_GAIN] * bend
        if omega > 0.0:
            out[1, i] += p[MODE_RATE_GAIN] * bend_rate / omega
        out[2, i] = (V * normal_0 + slow[A_X, j] * sa) / ca - p[IMU_ARM] * qdot_0
        out[3, i] = theta
        # A search may try an unstable aircraft: its motion stays finite, and is rejected by its cost.
        alpha = min(max(a0 + h * ka, -1.5), 1.5)
        q = min(max(q0 + h * kq, -15.0), 15.0)
        theta += 0.5 * h * (q0 + q) * cb
        lift_state = lift_decay * lift_state + (1.0 - lift_decay) * (0.5 * (a0 + alpha) + air)
        if omega > 0.0:
            off = bend - d
            bend = d + fade * ((swing_cos + zeta * swing_sin) * off + swing_sin * bend_rate / omega)
            bend_rate = fade * ((swing_cos - zeta * swing_sin) * bend_rate - omega * swing_sin * off)
    return out


@njit(cache=True)
def read_off(series: FloatArray, h: float, stamps: FloatArray, skew: float) -> FloatArray:
    """The simulated channel at its measurements' own stamps; ``skew`` > 0: the channel is late."""
    y = np.empty(len(stamps))
    last = len(series) - 1
    for i in range(len(stamps)):
        x = (stamps[i] - skew) / h
        k = min(max(int(x), 0), last - 1)
        f = min(max(x - k, 0.0), 1.0)
        y[i] = series[k] + f * (series[k + 1] - series[k])
    return y


@njit(cache=True)
def read_rows(
    grid: FloatArray, h: float, stamps: FloatArray, output: np.ndarray, skews: FloatArray
) -> FloatArray:
    """All channels of a manoeuvre at once: ``output`` says which row of ``grid`` each stamp reads."""
    y = np.empty(len(stamps))
    last = grid.shape[1] - 1
    for i in range(len(stamps)):
        c = output[i]
        x = (stamps[i] - skews[c]) / h
        k = min(max(int(x), 0), last - 1)
        f = min(max(x - k, 0.0), 1.0)
        y[i] = grid[c, k] + f * (grid[c, k + 1] - grid[c, k])
    return y
