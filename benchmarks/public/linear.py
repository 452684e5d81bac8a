"""A linear model of both axes with drag and thrust, simulated freely with the commands alone.

Kinematics are exact. Each specific force and each angular acceleration is a sum of coefficients times
factors: angles and controls times dynamic pressure, rates times air speed. Coefficients belong to
``REFERENCE_M_S``.
"""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.process.arrays import FloatArray
from benchmarks.public.segments import CONTROLS, Segment

ROWS = ("X", "Y", "Z", "L", "M", "N")
"""Specific forces along the body axes, m/s², and angular accelerations about them, rad/s²."""
FACTORS = ("one", "0", "alpha", "beta", "p", "q", "r", *CONTROLS)
"""Factors of the coefficients: 1, dynamic pressure over its reference, angles, rates, and commands."""
_PITCH = ("0", "alpha", "q", "throttle", "elevator")
_SIDE = ("0", "beta", "p", "r", "throttle", "aileron", "rudder")
TERMS: Mapping[str, tuple[str, ...]] = {
    "X": ("one", "0", "alpha", "throttle"), "Z": _PITCH, "M": _PITCH, "Y": _SIDE, "L": _SIDE, "N": _SIDE,
}  # fmt: skip
"""Factors that each row of the model has."""
FREE = np.array([[factor in TERMS[row] for factor in FACTORS] for row in ROWS])
"""Shape (6, 11): coefficients that the model has."""
TRIMS = np.tile([factor == "0" for factor in FACTORS], (len(ROWS), 1))
"""Shape (6, 11): coefficients that are trims, one a row."""
REFERENCE_M_S = 4.5
"""Air speed of the coefficients, m/s: near the mean of the segments. Predictions do not depend on it."""
SLOWEST_M_S = 0.5
"""Least air speed of a simulation, m/s, below which angles of flow have no meaning."""
LARGEST = 60.0
"""Largest rate of change of a state, 1/s, with which a simulation that runs away continues."""


def factors(velocity: FloatArray, rates: FloatArray, commands: FloatArray) -> FloatArray:
    """Return the factors (..., 11) at velocities (..., 3), m/s, rates (..., 3), rad/s, commands (..., 4)."""
    u, v, w = np.moveaxis(velocity, -1, 0)
    speed = np.maximum(np.sqrt(u * u + v * v + w * w), SLOWEST_M_S)
    ratio = speed / REFERENCE_M_S
    pressure = ratio * ratio
    found = np.empty((*speed.shape, len(FACTORS)))
    found[..., 0] = 1.0
    found[..., 1] = pressure
    found[..., 2] = pressure * np.arctan2(w, u)
    found[..., 3] = pressure * np.arcsin(np.clip(v / speed, -1.0, 1.0))
    found[..., 4:7] = ratio[..., None] * rates
    found[..., 7] = commands[..., 0]
    found[..., 8:] = pressure[..., None] * commands[..., 1:]
    return found


def commands_of(segment: Segment) -> FloatArray:
    """Return throttle, elevator, aileron and rudder, (n, 4), in strokes."""
    return np.column_stack([segment.commands[name] for name in CONTROLS])


def simulated(coefficients: FloatArray, segment: Segment) -> FloatArray:
    """Return the states (k, n, 13) of k models (k, 6, 11) that begin in the first measured state."""
    commands = commands_of(segment)
    states = np.empty((len(coefficients), len(segment.t), segment.states.shape[1]))
    states[:, 0] = segment.states[0]
    for i, step_s in enumerate(np.diff(segment.t)):
        x = states[:, i]
        k1 = _rates(coefficients, x, commands[i])
        k2 = _rates(coefficients, x + 0.5 * step_s * k1, commands[i])
        k3 = _rates(coefficients, x + 0.5 * step_s * k2, commands[i])
        k4 = _rates(coefficients, x + step_s * k3, commands[i])
        states[:, i + 1] = x + step_s / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    return states


def _rates(coefficients: FloatArray, x: FloatArray, commands: FloatArray) -> FloatArray:
    """Return the rates of change (k, 13) of states (k, 13) in the order of the file."""
    u, v, w, q_w, q_x, q_y, q_z, p, q, r = x[:, 3:].T
    each = factors(x[:, 3:6], x[:, 10:13], np.broadcast_to(commands, (len(x), 4)))
    acceleration = np.einsum("kij,kj->ik", coefficients, each)
    earth = np.array(
        [
            [
                1.0 - 2.0 * (q_y * q_y + q_z * q_z),
                2.0 * (q_x * q_y - q_w * q_z),
                2.0 * (q_x * q_z + q_w * q_y),
            ],
            [
                2.0 * (q_x * q_y + q_w * q_z),
                1.0 - 2.0 * (q_x * q_x + q_z * q_z),
                2.0 * (q_y * q_z - q_w * q_x),
            ],
            [
                2.0 * (q_x * q_z - q_w * q_y),
                2.0 * (q_y * q_z + q_w * q_x),
                1.0 - 2.0 * (q_x * q_x + q_y * q_y),
            ],
        ]
    )
    weight = GRAVITY_M_S2 * earth[2]
    found = [
        *(row[0] * u + row[1] * v + row[2] * w for row in earth),
        r * v - q * w + weight[0] + acceleration[0],
        p * w - r * u + weight[1] + acceleration[1],
        q * u - p * v + weight[2] + acceleration[2],
        -0.5 * (p * q_x + q * q_y + r * q_z),
        0.5 * (p * q_w + r * q_y - q * q_z),
        0.5 * (q * q_w + p * q_z - r * q_x),
        0.5 * (r * q_w + q * q_x - p * q_y),
        *acceleration[3:],
    ]
    return np.asarray(np.clip(np.array(found).T, -LARGEST, LARGEST))
