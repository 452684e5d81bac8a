"""Equations of motion of the bundled nonlinear aircraft and their integration.

The motion is longitudinal along the flight path, with a bank angle in coordinated turns. The equations are
the wind-axes force equations with β = 0 (Stevens & Lewis, *Aircraft Control and Simulation*):

    V̇ = (T cos α − D)/m − g sin γ
    α̇ = q − (L + T sin α)/(m V) + (g/V) cos γ cos μ
    q̇ = M / I_yy

The state's V and α belong to the motion through the steadily moving air mass. A gust's vertical speed w (up)
adds w/V to the α of wing and vane. The head wind u adds to the speed.
"""

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.process.compiled import kernel

from .airframe import AIR_DENSITY_KG_M3, GRAVITY_M_S2

FloatArray = NDArray[np.float64]

STATES = ("airspeed", "alpha", "q", "theta", "height", "phi", "p", "alpha_late")
"""Names of the states, in m/s, rad, rad/s, rad, m, rad, rad/s, rad (the last is the lagging share of α in
lift)."""

INPUTS = ("elevator", "throttle", "aileron", "gust_up", "gust_head", "extra_cl", "extra_cm")
"""Inputs, in rad, 0..1, −1..1, m/s, m/s; then lift and moment coefficients added from outside."""

DERIVATIVES = (*(f"{name}_dot" for name in STATES), "a_x", "a_z")
"""Entries in the result of :func:`derivatives`: rates of the states, then specific forces, m/s²."""


@kernel()
def derivatives(
    x: NDArray[np.float64], u: NDArray[np.float64], airframe: Any, dx: NDArray[np.float64]
) -> None:
    """Fill ``dx`` (10,), see ``DERIVATIVES``, from state ``x`` (8,) and inputs ``u`` (7,).

    ``airframe`` is the structured array of :func:`sim.airframe.as_record`.
    """
    a = airframe[0]
    speed, alpha, q, theta, height, phi, p = x[0], x[1], x[2], x[3], x[4], x[5], x[6]
    elevator, throttle, aileron = u[0], u[1], u[2]

    air_speed = speed + u[4]
    air_alpha = alpha + u[3] / speed
    late_alpha = air_alpha - a.unsteady_share * (air_alpha - x[7])
    force = 0.5 * AIR_DENSITY_KG_M3 * air_speed * air_speed * a.wing_area
    rate = a.chord / (2.0 * air_speed)
    off = air_alpha - a.alpha_ref
    off_elevator = elevator - a.delta_e_ref
    ground = math.exp(-max(height, 0.0) / a.span)

    cl_wing = a.cl_0 + a.cl_alpha * late_alpha + a.cl_alpha2 * off * off + a.cl_alpha3 * off * off * off
    if a.stall_alpha > 0.0:
        attached = 0.5 * (1.0 - math.tanh(a.stall_sharpness * (air_alpha - a.stall_alpha)))
        cl_wing *= (0.5 * (1.0 + math.sqrt(attached))) ** 2
    cl = cl_wing * (1.0 + a.ground_lift * ground) + a.cl_q * q * rate + a.cl_delta_e * elevator + u[5]
    cd = a.cd_0 + a.cd_induced * cl * cl
    lift, drag = force * cl, force * cd
    thrust = throttle * a.thrust_max * max(0.0, 1.0 - speed / a.thrust_zero_speed)

    sin_a, cos_a = math.sin(alpha), math.cos(alpha)
    sin_t, cos_t = math.sin(theta), math.cos(theta)
    cos_phi = math.cos(phi)
    sin_gamma = sin_t * cos_a - cos_t * cos_phi * sin_a
    # Lift and drag refer to the air that the wing meets; they are turned into the axes of the state.
    slip = air_alpha - alpha
    lift_path = lift * math.cos(slip) + drag * math.sin(slip)
    drag_path = drag * math.cos(slip) - lift * math.sin(slip)
    speed_dot = (thrust * cos_a - drag_path) / a.mass - GRAVITY_M_S2 * sin_gamma
    pushing = thrust
    if a.speed_held > 0.0:
        thrust += -a.mass * speed_dot / cos_a
        speed_dot = 0.0
    alpha_dot = (
        q
        - (lift_path + thrust * sin_a) / (a.mass * speed)
        + GRAVITY_M_S2 / speed * (sin_t * sin_a + cos_t * cos_phi * cos_a)
    )

    cm = (
        a.cm_0
        + a.cm_alpha * air_alpha
        + a.cm_alpha2 * off * off
        + a.cm_alpha3 * off * off * off
        + (a.cm_q * q + a.cm_alpha_dot * alpha_dot) * rate
        + a.cm_delta_e * elevator
        + a.cm_delta_e2 * off_elevator * off_elevator
        + a.cm_delta_e3 * off_elevator * off_elevator * off_elevator
        + a.ground_moment * ground
        + (cl * math.cos(air_alpha) + cd * math.sin(air_alpha)) * a.cg_aft / a.chord
        + u[6]
    )
    # An ideal speed hold acts at the centre of gravity, the throttle's thrust does not.
    moment = force * a.chord * cm + pushing * a.thrust_arm

    dx[0] = speed_dot
    dx[1] = alpha_dot
    dx[2] = moment / a.iyy
    dx[3] = q * cos_phi - GRAVITY_M_S2 / speed * math.sin(phi) ** 2 * cos_t
    dx[4] = speed * sin_gamma
    dx[5] = p
    dx[6] = (aileron * a.roll_rate_max - p) / a.roll_lag
    dx[7] = (air_alpha - x[7]) / a.unsteady_lag
    dx[8] = (thrust - drag_path * cos_a + lift_path * sin_a) / a.mass
    dx[9] = (-drag_path * sin_a - lift_path * cos_a) / a.mass


@kernel()
def step(
    x: FloatArray,
    u_from: FloatArray,
    u_to: FloatArray,
    airframe: Any,
    dt: float,
    dx: FloatArray,
) -> None:
    """Advance ``x`` in place by ``dt`` with classical Runge–Kutta and inputs that change linearly.

    On return ``dx`` (10,) holds the derivatives at the new state.
    """
    n = len(x)
    u_mid = 0.5 * (u_from + u_to)
    k = np.empty_like(dx)
    trial = np.empty_like(x)
    total = np.empty_like(x)
    derivatives(x, u_from, airframe, k)
    for i in range(n):
        total[i] = k[i]
        trial[i] = x[i] + 0.5 * dt * k[i]
    derivatives(trial, u_mid, airframe, k)
    for i in range(n):
        total[i] += 2.0 * k[i]
        trial[i] = x[i] + 0.5 * dt * k[i]
    derivatives(trial, u_mid, airframe, k)
    for i in range(n):
        total[i] += 2.0 * k[i]
        trial[i] = x[i] + dt * k[i]
    derivatives(trial, u_to, airframe, k)
    for i in range(n):
        x[i] += dt / 6.0 * (total[i] + k[i])
    derivatives(x, u_to, airframe, dx)
