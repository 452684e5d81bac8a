"""Motion of a rigid body over a flat earth by Newton and Euler, with servos of first order."""

from typing import NamedTuple

import numpy as np

from benchmarks.second_generator.kernel import Floats, kernel

GRAVITY = 9.80665
STEP_S = 0.005
HEIGHT_M = 150.0
"""Height above home at which the pilot flies, m."""


class Numbers(NamedTuple):
    """Numbers of the equations, SI, per rad.

    Coefficients of lift, drag, pitching moment, side force (cy), rolling (cl) and yawing moment (cn), by
    sideslip b, rates p, q and r, and elevator, aileron and rudder.
    """

    mass: float
    ixx: float
    iyy: float
    izz: float
    ixz: float
    area: float
    chord: float
    span: float
    density: float
    thrust: float
    lift_0: float
    lift_alpha: float
    lift_q: float
    lift_de: float
    drag_0: float
    induced: float
    cm_0: float
    cm_alpha: float
    cm_q: float
    cm_de: float
    cy_b: float
    cy_p: float
    cy_r: float
    cy_da: float
    cy_dr: float
    cl_b: float
    cl_p: float
    cl_r: float
    cl_da: float
    cl_dr: float
    cn_b: float
    cn_p: float
    cn_r: float
    cn_da: float
    cn_dr: float


def level_state(speed: float, alpha: float) -> Floats:
    """Return the state of level flight: u, v, w, p, q, r, φ, θ and height."""
    return np.array([speed * np.cos(alpha), 0.0, speed * np.sin(alpha), 0.0, 0.0, 0.0, 0.0, alpha, HEIGHT_M])


@kernel
def rates(x: Floats, surfaces: Floats, n: Numbers) -> tuple[Floats, Floats]:
    """Return the rates of the state and the specific force in body axes, m/s²."""
    u, v, w, p, q, r, phi, theta = x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7]
    speed = np.sqrt(u * u + v * v + w * w)
    alpha, beta = np.arctan2(w, u), np.arcsin(v / speed)
    long, wide = n.chord / (2.0 * speed), n.span / (2.0 * speed)
    de, da, dr = surfaces[0], surfaces[1], surfaces[2]
    lift = n.lift_0 + n.lift_alpha * alpha + n.lift_q * long * q + n.lift_de * de
    drag = n.drag_0 + n.induced * lift * lift
    cm = n.cm_0 + n.cm_alpha * alpha + n.cm_q * long * q + n.cm_de * de
    cy = n.cy_b * beta + wide * (n.cy_p * p + n.cy_r * r) + n.cy_da * da + n.cy_dr * dr
    cl = n.cl_b * beta + wide * (n.cl_p * p + n.cl_r * r) + n.cl_da * da + n.cl_dr * dr
    cn = n.cn_b * beta + wide * (n.cn_p * p + n.cn_r * r) + n.cn_da * da + n.cn_dr * dr
    pressed = 0.5 * n.density * speed * speed * n.area
    sin, cos = np.sin(alpha), np.cos(alpha)
    felt = np.empty(3)
    felt[0] = (pressed * (lift * sin - drag * cos) + n.thrust) / n.mass
    felt[1] = pressed * cy / n.mass
    felt[2] = pressed * (-lift * cos - drag * sin) / n.mass
    # Euler's equations with the product of inertia I_xz.
    rolling = pressed * n.span * cl + n.ixz * p * q + (n.iyy - n.izz) * q * r
    yawing = pressed * n.span * cn - n.ixz * q * r + (n.ixx - n.iyy) * p * q
    both = n.ixx * n.izz - n.ixz * n.ixz
    turn = q * np.sin(phi) + r * np.cos(phi)
    out = np.empty(9)
    out[0] = felt[0] - GRAVITY * np.sin(theta) + r * v - q * w
    out[1] = felt[1] + GRAVITY * np.cos(theta) * np.sin(phi) + p * w - r * u
    out[2] = felt[2] + GRAVITY * np.cos(theta) * np.cos(phi) + q * u - p * v
    out[3] = (n.izz * rolling + n.ixz * yawing) / both
    out[4] = (pressed * n.chord * cm + (n.izz - n.ixx) * p * r - n.ixz * (p * p - r * r)) / n.iyy
    out[5] = (n.ixz * rolling + n.ixx * yawing) / both
    out[6] = p + np.tan(theta) * turn
    out[7] = q * np.cos(phi) - r * np.sin(phi)
    out[8] = u * np.sin(theta) - np.cos(theta) * (v * np.sin(phi) + w * np.cos(phi))
    return out, felt


@kernel
def rates_in_gust(x: Floats, surfaces: Floats, gust: Floats, n: Numbers) -> tuple[Floats, Floats]:
    """Return the rates of the state (9,) and the specific force; the gust (3,) is in body axes, m/s."""
    through = x.copy()
    through[:3] -= gust
    out, felt = rates(through, surfaces, n)
    p, q, r = x[3], x[4], x[5]
    out[0] += r * gust[1] - q * gust[2]
    out[1] += p * gust[2] - r * gust[0]
    out[2] += q * gust[0] - p * gust[1]
    phi, theta = x[6], x[7]
    sideways = gust[1] * np.sin(phi) + gust[2] * np.cos(phi)
    out[8] += gust[0] * np.sin(theta) - np.cos(theta) * sideways
    return out, felt


@kernel
def stepped(x: Floats, surfaces: Floats, after: Floats, gust: Floats, n: Numbers) -> tuple[Floats, Floats]:
    """Return the state after a step, and the specific force before it; surfaces go to ``after``, rad."""
    middle = 0.5 * (surfaces + after)
    k1, felt = rates_in_gust(x, surfaces, gust, n)
    k2, _ = rates_in_gust(x + 0.5 * STEP_S * k1, middle, gust, n)
    k3, _ = rates_in_gust(x + 0.5 * STEP_S * k2, middle, gust, n)
    k4, _ = rates_in_gust(x + STEP_S * k3, after, gust, n)
    return x + STEP_S / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4), felt


@kernel
def flown(
    x: Floats,
    asked: Floats,
    hands: Floats,
    gains: Floats,
    trim: Floats,
    lags_s: Floats,
    us_per_rad: float,
    n: Numbers,
) -> tuple[Floats, Floats, Floats]:
    """Return the states (n, 9), specific forces (n, 3) and pulses (n, 3) of a flight.

    Parameters
    ----------
    asked
        Shape (n, 3): deflections from trim of elevator, aileron and rudder that the script asks, rad.
    hands
        Shape (n,): 1 where a pilot flies; elsewhere the surfaces hold the pilot's last deflections.
    gains
        Shape (5,): elevator by pitch angle and pitch rate, aileron by bank and roll rate, rad and s, and path
        angle by height, rad/m.
    trim
        Shape (2,): angle of attack and elevator of level flight, rad.
    """
    count = len(asked)
    states, forces, pulses = np.empty((count, 9)), np.empty((count, 3)), np.empty((count, 3))
    held = np.array([trim[1], 0.0, 0.0])
    surfaces, kept, still = held.copy(), np.exp(-STEP_S / lags_s), np.zeros(3)
    for k in range(count):
        if hands[k] > 0.5:
            path = min(max(gains[4] * (HEIGHT_M - x[8]), -0.06), 0.06)
            held[0] = trim[1] + gains[0] * (x[7] - trim[0] - path) + gains[1] * x[4]
            held[1] = gains[2] * x[6] + gains[3] * x[3]
        pulses[k] = np.floor(1500.5 + us_per_rad * (held + asked[k]))
        told = (pulses[k] - 1500.0) / us_per_rad
        after = told + (surfaces - told) * kept
        states[k] = x
        x, forces[k] = stepped(x, surfaces, after, still, n)
        surfaces = after
    return states, forces, pulses
