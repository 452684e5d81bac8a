"""Compiled equations of motion of the paper's linear model with further effects."""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.process.compiled import kernel

from .airframe import GRAVITY_M_S2

ROLL_RATE_MAX = 2.0
ROLL_LAG_S = 0.15


@kernel()
def _bent(angle: float, trimmed: float, about: float, square: float, cube: float) -> float:
    """Return the square and cube of an angle relative to another, minus their values at the trim."""
    off, usual = angle - about, trimmed - about
    return square * (off**2 - usual**2) + cube * (off**3 - usual**3)


@kernel()
def rates(x: NDArray[np.float64], u: NDArray[np.float64], model: Any, dx: NDArray[np.float64]) -> None:
    """Fill ``dx`` from x = [α, q, θ, h, φ, p, α_late, P_late] and u = [δe, P, aileron, w, V, ΔZ, ΔM, V̇].

    P is the throttle, and P_late its value after the engine's lag.
    """
    m = model[0]
    alpha, q, theta, height, phi, p, late = x[0], x[1], x[2], x[3], x[4], x[5], x[6]
    throttle = x[7] if m.throttle_lag > 0.0 else u[1]
    elevator, speed = u[0], u[4]
    air = alpha + u[3] / speed
    behind = m.unsteady_share * (air - late)
    lifting, turning = air - behind, air - m.unsteady_moment * behind
    off_elevator = elevator - m.delta_ref
    gamma = theta - alpha
    ratio, power, turn, weight, gravity = 1.0, 1.0, 1.0, GRAVITY_M_S2 / m.speed_ref, 0.0
    wing = m.Z_0 - weight + m.Z_alpha * lifting
    if m.speed_scaled > 0.0:
        ratio, weight = speed / m.speed_ref, GRAVITY_M_S2 / speed
        power, turn = ratio**m.speed_power, ratio**m.moment_power
    if m.stall_sharpness > 0.0:
        stalled = 0.5 * (1.0 + math.tanh(m.stall_sharpness * (air - m.stall_alpha)))
        wing *= ((1.0 + math.sqrt(1.0 - stalled)) / 2.0) ** 2
    if m.gravity > 0.0:
        gravity = GRAVITY_M_S2 / speed * (math.cos(gamma) * math.cos(phi) - 1.0)
    ground = 0.0
    if m.Z_h != 0.0 or m.M_h != 0.0 or m.lift_h != 0.0:
        ground = math.exp(-max(height, 0.0) / m.ground_scale)
    alpha_dot = (
        weight
        + gravity
        + ratio
        * power
        * (
            (wing + m.Z_delta_e * elevator + _bent(air, m.alpha_ref, m.Z_about, m.Z_alpha2, m.Z_alpha3))
            * (1.0 + m.lift_h * ground)
            + m.Z_h * ground
        )
        + (1.0 + m.Z_q) * q
        + u[5]
    )
    q_dot = (
        ratio * (m.M_q * q + m.M_alpha_dot * alpha_dot)
        + ratio**2
        * power
        * turn
        * (
            m.M_0
            + m.M_alpha * turning
            + m.M_delta_e * elevator
            + _bent(air, m.alpha_ref, m.M_about, m.M_alpha2, m.M_alpha3)
            + _bent(elevator, m.delta_ref, m.delta_about, m.M_delta2, m.M_delta3)
            + m.M_h * ground
        )
        + m.M_throttle * (throttle - m.throttle_ref)
        + (m.M_thrust + power * m.washed_share * m.M_delta_e * off_elevator) * (1.0 - ratio**2)
        + power * m.blown_share * m.M_delta_e * off_elevator * (u[7] / GRAVITY_M_S2 + math.sin(gamma))
        + u[6]
    )
    dx[0] = alpha_dot
    dx[1] = q_dot
    dx[2] = q
    dx[3] = speed * math.sin(gamma)
    dx[4] = p
    dx[5] = (u[2] * ROLL_RATE_MAX - p) / ROLL_LAG_S
    dx[6] = (air - late) / m.unsteady_lag
    dx[7] = (u[1] - x[7]) / m.throttle_lag if m.throttle_lag > 0.0 else 0.0


@kernel()
def step(
    x: NDArray[np.float64],
    u_from: NDArray[np.float64],
    u_to: NDArray[np.float64],
    model: Any,
    dt: float,
    dx: NDArray[np.float64],
) -> None:
    """Advance ``x`` by ``dt`` (classical Runge–Kutta, inputs linear); ``dx`` is then the rates there."""
    u_mid = 0.5 * (u_from + u_to)
    k1, k2, k3, k4 = np.empty_like(x), np.empty_like(x), np.empty_like(x), np.empty_like(x)
    rates(x, u_from, model, k1)
    rates(x + 0.5 * dt * k1, u_mid, model, k2)
    rates(x + 0.5 * dt * k2, u_mid, model, k3)
    rates(x + dt * k3, u_to, model, k4)
    x += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    rates(x, u_to, model, dx)
