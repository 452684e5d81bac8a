"""Longitudinal equations of motion: strips of a wing, and a tail in the downwash of a moment ago."""

from typing import NamedTuple

import numba
import numpy as np

from .fleet import GRAVITY_M_S2, Floats

STATES = (
    "u",
    "w",
    "q",
    "theta",
    "height",
    "downwash",
    "wake",
    "bend",
    "bend_rate",
    "swing",
    "swing_rate",
    "flex",
    "flex_rate",
)
"""``wake``: lagged angle of attack of an unsteady wing; the six after it belong to three oscillators."""

WAKE_DELAY = 0.35
"""Mean delay of the downwash over x_t / V: the bound vortex acts at once, the wake as it passes the tail."""


class Faults(NamedTuple):
    """What an effect adds to the motion; as it stands, nothing."""

    alpha_0: float = 0.0
    """Trim about which nonlinear laws bend [rad]."""
    delta_0: float = 0.0
    flap_square: float = 0.0
    """Departure of the elevator's effective deflection, 1/rad and 1/rad^2."""
    flap_cube: float = 0.0
    moment_square: float = 0.0
    moment_cube: float = 0.0
    thrust_arm: float = 0.0
    """Thrust line below the centre of gravity [m]."""
    alpha_dot: float = 0.0
    """Pitching moment by (d alpha/dt) c / 2V."""
    kink: float = 0.0
    """Share of the lift slope lost above ``kink_at``."""
    kink_at: float = 0.0
    wake_share: float = 0.0
    wake_chords: float = 1.0
    wing_power: float = 0.0
    """Coefficients go with (V / V_0) to this power, beyond dynamic pressure."""
    tail_power: float = 0.0
    ground: float = 0.0
    bend: float = 0.0
    bend_rad_s: float = 1.0
    swing: float = 0.0
    """Moment of a hanging load, by angle and by weight of the aircraft times chord."""
    swing_m: float = 1.0
    flex: float = 0.0
    flex_rad_s: float = 1.0
    spoiler: float = 0.0
    """Share of lift lost while the spoilers float."""


class Around(NamedTuple):
    """What surrounds the aircraft at one moment."""

    updraft: float = 0.0
    headwind: float = 0.0
    moment: float = 0.0
    """Added pitching-moment coefficient."""
    lift: float = 0.0
    cg: float = 0.0
    """Centre of gravity aft of the file's [m]."""
    weight: float = 1.0
    """Mass over the file's."""
    ice: float = 0.0
    spoilers: float = 0.0


@numba.njit(cache=True)
def section_lift(alpha: float, slope: float, limit: float) -> float:
    """Lift coefficient of a strip: straight at first, then bending towards its largest value."""
    wanted = slope * alpha / limit
    fourth = wanted * wanted * wanted * wanted
    return limit * wanted / np.sqrt(np.sqrt(np.sqrt(1.0 + fourth * fourth)))


@numba.njit(cache=True)
def slopes(y, delta, throttle, around, shape, faults):  # type: ignore[no-untyped-def]
    """Time derivative of the state, specific force along body x and z at the centre of gravity [m/s^2]."""
    u, w, q, theta = y[0], y[1], y[2], y[3]
    u_air, w_air = u + around.headwind, w + around.updraft * np.cos(theta)
    speed = np.sqrt(u_air * u_air + w_air * w_air)
    alpha = np.arctan2(w_air, u_air)
    pressure = 0.5 * shape.density * speed * speed
    ratio = speed / shape.speed_0

    # Wing.
    image = 0.0
    if faults.ground > 0.0:
        image = faults.ground * np.exp(-2.48 * (2.0 * max(y[4], 0.05) / shape.span) ** 0.768)
    wing_factor = ratio**faults.wing_power if faults.wing_power != 0.0 else 1.0
    tail_factor = ratio**faults.tail_power if faults.tail_power != 0.0 else 1.0
    slope = shape.wing_slope * wing_factor * (1.0 - around.ice) * (1.0 + 0.35 * image)
    felt = alpha + faults.wake_share * (y[6] - alpha)
    wing_lift, wing_moment = 0.0, 0.0
    for k in range(shape.strip_area.size):
        local = felt + shape.strip_twist[k] + q * (shape.strip_x[k] - around.cg) / speed
        if faults.kink > 0.0:
            # Smooth over a quarter of a degree.
            above = (alpha - faults.kink_at) / 0.0044
            local -= faults.kink * 0.0044 * np.logaddexp(0.0, above)
        share = shape.strip_share[k]
        lift = section_lift(local, slope * share, shape.section_limit * (1.0 - around.ice))
        wing_lift += lift * shape.strip_area[k]
        wing_moment -= lift * shape.strip_area[k] * (shape.strip_x[k] - around.cg)
    wing_coefficient = wing_lift / shape.area
    flexed = 1.0 + faults.flex * (y[11] / wing_coefficient - 1.0) if faults.flex != 0.0 else 1.0
    flexed *= 1.0 - faults.spoiler * around.spoilers
    wing_lift *= flexed
    wing_moment *= flexed

    # Tail, in the downwash of a moment ago.
    downwash = shape.downwash * wing_coefficient * (1.0 - image)
    turn = delta - faults.delta_0
    flap = delta + faults.flap_square * turn**2 + faults.flap_cube * turn**3
    tail_alpha = alpha + shape.tail_setting - y[5] + q * (shape.tail_x - around.cg) / speed
    bent = tail_alpha + faults.bend * (y[7] - tail_alpha)
    tail_lift = shape.tail_slope * (bent + shape.flap * flap) * tail_factor
    tail_lift *= (1.0 - 0.6 * around.ice) * shape.tail_area

    coefficient = (wing_lift + tail_lift) / shape.area + around.lift
    drag = shape.drag_0 * (1.0 + 1.5 * around.ice) + shape.induced * coefficient**2 * (1.0 - image)
    lift_n, drag_n = pressure * shape.area * coefficient, pressure * shape.area * drag
    thrust = throttle * shape.thrust_0 * (1.0 - lost_thrust(ratio, shape.thrust_fall))
    mass = shape.mass * around.weight
    a_x = (lift_n * np.sin(alpha) - drag_n * np.cos(alpha) + thrust) / mass
    a_z = (-lift_n * np.cos(alpha) - drag_n * np.sin(alpha)) / mass
    u_dot = a_x - q * w - GRAVITY_M_S2 * np.sin(theta)
    w_dot = a_z + q * u + GRAVITY_M_S2 * np.cos(theta)
    alpha_dot = (u_air * w_dot - w_air * u_dot) / speed**2

    moment = pressure * (wing_moment - tail_lift * (shape.tail_x - around.cg))
    bow = alpha - faults.alpha_0
    body = shape.fuselage * alpha + faults.moment_square * bow**2 + faults.moment_cube * bow**3
    body += around.moment + faults.alpha_dot * alpha_dot * shape.chord / (2.0 * speed)
    moment += pressure * shape.area * shape.chord * body + thrust * faults.thrust_arm
    moment -= faults.swing * shape.mass * GRAVITY_M_S2 * shape.chord * y[9]
    q_dot = moment / (shape.inertia * around.weight)

    out = np.empty(y.size)
    out[0], out[1], out[2], out[3] = u_dot, w_dot, q_dot, q
    out[4] = u * np.sin(theta) - w * np.cos(theta)
    out[5] = (downwash - y[5]) * speed / (WAKE_DELAY * shape.tail_x)
    out[6] = (alpha - y[6]) * speed / (faults.wake_chords * shape.chord)
    out[7], out[8] = y[8], oscillator(tail_alpha - y[7], y[8], faults.bend_rad_s, 0.12)
    own = np.sqrt(GRAVITY_M_S2 / faults.swing_m)
    out[9], out[10] = y[10], oscillator(-a_x / a_z - y[9], y[10], own, 0.08) - q_dot
    out[11], out[12] = y[12], oscillator(wing_coefficient - y[11], y[12], faults.flex_rad_s, 0.12)
    return out, a_x, a_z


@numba.njit(cache=True)
def lost_thrust(ratio: float, fall: float) -> float:
    """Share of the static thrust that is lost at a speed."""
    return 0.5 * fall * ratio


@numba.njit(cache=True)
def oscillator(stretch: float, rate: float, own_rad_s: float, damping: float) -> float:
    """Acceleration of a mass on a spring."""
    return own_rad_s * own_rad_s * stretch - 2.0 * damping * own_rad_s * rate


def at_rest(speed: float, alpha: float, height: float, downwash: float) -> Floats:
    """State in steady level flight, every memory filled."""
    y = np.zeros(len(STATES))
    y[0], y[1], y[3], y[4] = speed * np.cos(alpha), speed * np.sin(alpha), alpha, height
    y[5], y[6] = downwash, alpha
    return y
