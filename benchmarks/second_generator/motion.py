"""Nonlinear longitudinal motion of an aircraft in moving air, with every departure the effects may ask for.

Body axes, x forward and z down. The equations are those of Etkin and Reid, chapter 4, without lateral motion:

    u' = X/m - g sin(theta) - q w        w' = Z/m + g cos(theta) + q u
    q' = M/Iyy       theta' = q          h' = u sin(theta) - w cos(theta)

A departure whose size is zero (or whose threshold is out of reach) leaves the plain aircraft.
"""

from typing import NamedTuple

import numpy as np

from .flight_model import FlightModel
from .kernel import Floats, kernel

GRAVITY = 9.80665

# Places in the state vector.
U, W, Q, THETA, HEIGHT, LAGGED_ALPHA, MODE, MODE_RATE, SLOSH, SLOSH_RATE = range(10)
STATES = 10


class Surroundings(NamedTuple):
    """What surrounds and loads the aircraft at one instant.

    Winds [m/s] upward and from behind, the gust's pitch rate [rad/s]; the centre of gravity's way aft [m],
    mass added [share], ice [share of lift slope lost], a moment coefficient added.
    """

    upward: float
    behind: float
    pitching: float
    cg_aft: float
    mass_added: float
    ice: float
    moment_added: float


class Kinematics(NamedTuple):
    """What instruments at the centre of gravity feel: specific force [m/s^2] and air data [m/s, rad]."""

    a_x: float
    a_z: float
    airspeed: float
    alpha: float


STILL_AIR = Surroundings(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@kernel
def density(altitude: float) -> float:
    """Air density [kg/m^3] of the standard atmosphere's troposphere at an altitude [m]."""
    return float(1.225 * (1.0 - 2.25577e-5 * altitude) ** 4.2559)


@kernel
def lift_coefficient(alpha: float, speed_factor: float, separated: float, model: FlightModel) -> float:
    """Steady lift coefficient of the whole aircraft at zero elevator and pitch rate."""
    # Kirchhoff's flow model: X is the chordwise point of separation, 1 when attached (Fischenberg, 1995).
    point = 0.5 * (1.0 - np.tanh(model.separation_sharpness * (alpha - model.separation_alpha)))
    attached = ((1.0 + np.sqrt(point)) / 2.0) ** 2
    off = alpha - model.alpha
    table = model.table_slope_above * max(off - model.table_break, 0.0)
    table += model.table_slope_below * min(off + model.table_break, 0.0)
    polynomial = model.cl_alpha_2 * off**2 + model.cl_alpha_3 * off**3
    lift = model.cl_0 + speed_factor * model.cl_alpha * attached * alpha + polynomial + table
    return float(lift - separated * model.hysteresis_lift)


@kernel
def elevator_moment(elevator: float, alpha: float, pitch_rate_hat: float, model: FlightModel) -> float:
    """Pitching moment coefficient of the elevator, about its trim position where it is nonlinear."""
    off = elevator - model.elevator
    moment = model.cm_delta_e * elevator + model.cm_delta_2 * off**2 + model.cm_delta_3 * off**3
    # The tail meets half of the angle of attack, its own motion, and the elevator as camber.
    tail_angle = 0.5 * (alpha - model.alpha) + model.tail_arm * pitch_rate_hat + 0.6 * off
    beyond = max(abs(tail_angle) - model.tail_stall_angle, 0.0)
    return float(moment - model.tail_stall_loss * model.cm_delta_e * beyond * np.sign(tail_angle))


@kernel
def derivatives(
    state: Floats,
    time: float,
    elevator: float,
    thrust: float,
    around: Surroundings,
    separated: float,
    model: FlightModel,
    out: Floats,
) -> Kinematics:
    """Write the time derivative of `state` to `out` and return what instruments would feel."""
    u, w, q, theta = state[U], state[W], state[Q], state[THETA]
    sin_theta, cos_theta = np.sin(theta), np.cos(theta)
    u_air = u - around.behind * cos_theta - around.upward * sin_theta
    w_air = w - around.behind * sin_theta + around.upward * cos_theta
    airspeed = np.sqrt(u_air**2 + w_air**2)
    alpha = np.arctan2(w_air, u_air)
    q_air = q + around.pitching
    pressure = 0.5 * density(model.elevation + state[HEIGHT]) * airspeed**2
    rate_hat = q_air * model.chord / (2.0 * airspeed)
    speed_factor = (airspeed / model.airspeed) ** model.speed_exponent
    near_ground = np.exp(-max(state[HEIGHT], 0.0) / model.span)
    off = alpha - model.alpha

    lift_alpha = alpha - model.lag_share * (alpha - state[LAGGED_ALPHA])
    cl = lift_coefficient(lift_alpha, speed_factor, separated, model)
    cl -= around.ice * model.cl_alpha * alpha
    cl += model.cl_q * rate_hat + (1.0 - 1.2 * around.ice) * speed_factor * model.cl_delta_e * elevator
    cl -= model.blowback_lift * ((airspeed / model.airspeed) ** 2 - 1.0)
    cl += (
        model.buffet_lift
        * np.sin(model.buffet_frequency * time)
        * min(max((alpha - model.buffet_alpha) / 0.01, 0.0), 1.0)
    )
    cl *= 1.0 + model.ground_lift * near_ground
    cd = model.cd_0 * (1.0 + 4.0 * around.ice) + model.induced_drag * cl**2

    mass = model.mass * (1.0 + around.mass_added)
    force = pressure * model.wing_area
    a_x = (force * (cl * np.sin(alpha) - cd * np.cos(alpha)) + thrust) / mass
    a_z = -force * (cl * np.cos(alpha) + cd * np.sin(alpha)) / mass
    u_dot = a_x - GRAVITY * sin_theta - q * w
    w_dot = a_z + GRAVITY * cos_theta + q * u
    alpha_dot = (u * w_dot - w * u_dot) / (u**2 + w**2)

    cm = model.cm_0 + (1.0 - 0.8 * around.ice) * speed_factor * model.cm_alpha * alpha
    cm += model.cm_alpha_2 * off**2 + model.cm_alpha_3 * off**3
    cm += model.pitch_up_slope * max(off - model.pitch_up_break, 0.0)
    cm += (model.cm_q + model.damping_asymmetry * np.sign(q)) * rate_hat
    cm += model.cm_alpha_dot * alpha_dot * model.chord / (2.0 * airspeed)
    power = (thrust - model.thrust) / model.thrust if model.thrust > 0.0 else 0.0
    effectiveness = speed_factor * (1.0 - 1.2 * around.ice) * (1.0 + model.slipstream * power)
    cm += effectiveness * elevator_moment(elevator, alpha, rate_hat, model)
    cm += cl * around.cg_aft / model.chord - model.ground_moment * near_ground + around.moment_added
    moment = force * model.chord * cm + thrust * model.thrust_arm
    q_dot = moment / (model.pitch_inertia * (1.0 + 0.6 * around.mass_added)) + model.slosh_gain * state[SLOSH]

    omega = model.mode_frequency
    load_factor = -a_z / GRAVITY - 1.0
    drive = (
        model.mode_from_elevator * (elevator - model.elevator)
        + (1.0 - model.mode_from_elevator) * load_factor
    )
    wave = model.slosh_frequency
    out[U], out[W], out[Q], out[THETA] = u_dot, w_dot, q_dot, q
    out[HEIGHT] = u * sin_theta - w * cos_theta
    out[LAGGED_ALPHA] = (alpha - state[LAGGED_ALPHA]) / model.lag_time
    out[MODE] = state[MODE_RATE]
    out[MODE_RATE] = omega**2 * (drive - state[MODE]) - 2.0 * model.mode_damping * omega * state[MODE_RATE]
    out[SLOSH] = state[SLOSH_RATE]
    out[SLOSH_RATE] = -(wave**2) * (state[SLOSH] + a_x / GRAVITY)
    out[SLOSH_RATE] -= 2.0 * model.slosh_damping * wave * state[SLOSH_RATE]
    return Kinematics(a_x, a_z, airspeed, alpha)


@kernel
def advance(
    state: Floats,
    time: float,
    step: float,
    elevators: tuple[float, float],
    thrust: float,
    around: Surroundings,
    separated: float,
    model: FlightModel,
    slopes: Floats,
) -> None:
    """One step of the classical Runge-Kutta method, in place; `slopes` is room for four derivatives."""
    first, last = elevators
    middle = 0.5 * (first + last)
    derivatives(state, time, first, thrust, around, separated, model, slopes[0])
    derivatives(
        state + 0.5 * step * slopes[0], time + 0.5 * step, middle, thrust, around, separated, model, slopes[1]
    )
    derivatives(
        state + 0.5 * step * slopes[1], time + 0.5 * step, middle, thrust, around, separated, model, slopes[2]
    )
    derivatives(state + step * slopes[2], time + step, last, thrust, around, separated, model, slopes[3])
    state += step / 6.0 * (slopes[0] + 2.0 * slopes[1] + 2.0 * slopes[2] + slopes[3])
