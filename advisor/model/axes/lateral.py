"""The lateral-directional axis: sideslip β, roll rate p, yaw rate r and bank φ, by aileron and rudder.

    β̇ = s·(Y_β·β + Y_δa·δa + Y_δr·δr + Y_0) + Y_p·p + Y_r·r + sin α·p - cos α·r + (g/V)·cos θ·sin φ
    ṗ = s²·(L_β·β + L_δa·δa + L_δr·δr + L_0) + s·(L_p·p + L_r·r)
    ṙ = s²·(N_β·β + N_δa·δa + N_δr·δr + N_0) + s·(N_p·p + N_r·r)
    φ̇ = p + tan θ·(q·sin φ + r·cos φ)

α, θ, V and q are known signals. L and N hold the products of inertia (Klein & Morelli, *Aircraft System
Identification*, Ch. 3). Outputs are p, r, φ, a_y = V·(the parameters' part of β̇) and, where a vane measures
it, β + (x_β/V)·r. A positive aileron rolls the aircraft to the left, and a positive rudder yaws it to the
left.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS, SPEED_EXPONENTS
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axis import CONSTANT, Axis, Term
from advisor.process.arrays import FloatArray

_FACTORS = {"beta": "beta", "p": "p", "r": "r", "delta_a": "aileron", "delta_r": "rudder"}
_STATES = {"Y": "beta", "L": "p", "N": "r"}


def _term(name: str, factor: str) -> Term:
    return Term(name, _STATES[name[0]], factor, SPEED_EXPONENTS[name])


LATERAL = Axis(
    states=("beta", "p", "r", "bank"),
    inputs=("aileron", "rudder"),
    outputs=("p", "r", "bank", "a_y", "beta"),
    shared=tuple(_term(name, _FACTORS[name[2:]]) for name in SIDE_PARAMETERS),
    constants=tuple(_term(f"{letter}_0", CONSTANT) for letter in _STATES),
    biases=("p", "a_y"),
)
"""The lateral axis. The lateral axis. Biases of r and φ are no parameters, because they cannot be
distinguished from the constants of trim.
"""
CONTROLS = {"delta_a": "aileron", "delta_r": "rudder"}
"""Name of each control, by the ending of its derivatives."""


@dataclass(frozen=True, slots=True)
class Trim:
    """Steady flight about which the lateral motion is linear."""

    airspeed_m_s: float
    alpha_rad: float = 0.0
    theta_rad: float = 0.0


def state_matrix(theta: FloatArray, trim: Trim) -> FloatArray:
    """Return A of ẋ = A·x about wings-level flight, shape (4, 4), for ``theta`` (15,) at reference speed."""
    a = np.zeros((4, 4))
    for value, (row, column, _) in zip(theta, LATERAL.place, strict=False):
        if column < 4:
            a[row, column] = value
    a[0, 1] += np.sin(trim.alpha_rad)
    a[0, 2] -= np.cos(trim.alpha_rad)
    a[0, 3] = GRAVITY_M_S2 / trim.airspeed_m_s * np.cos(trim.theta_rad)
    a[3, 1], a[3, 2] = 1.0, np.tan(trim.theta_rad)
    return a


@dataclass(frozen=True, slots=True)
class Modes:
    """Modes of the lateral motion; None for a mode that the aircraft does not have."""

    dutch_roll: complex | None
    """Dutch roll eigenvalue with positive imaginary part, 1/s."""
    roll: float | None
    """Eigenvalue of the roll subsidence, 1/s."""
    spiral: float | None
    """Eigenvalue of the spiral, 1/s."""


def modes_of(a: FloatArray) -> Modes:
    """Return the modes of a state matrix (4, 4).

    The faster oscillation is the Dutch roll. Roll and spiral modes that form one oscillation are not
    separate.
    """
    values = np.linalg.eigvals(a)
    swinging = sorted((complex(v) for v in values if v.imag > 1e-9), key=abs)
    real = sorted(float(v.real) for v in values if abs(v.imag) <= 1e-9)
    oscillation = swinging[-1] if swinging else None
    if len(real) != 2:
        return Modes(oscillation, None, None)
    return Modes(oscillation, min(real, key=lambda v: -abs(v)), max(real, key=lambda v: -abs(v)))


def natural_size(theta: FloatArray) -> Mapping[str, float]:
    """Return the typical size of each derivative on an aircraft with these derivatives (15,).

    Two rates set the size: the roll mode's, |L_p|, and the Dutch roll's, √|N_β|. A control has the
    size of the larger of its two moments; its force turns the path as fast as this moment does within 1/ω.
    A control that was not flown has no moment yet; its size is ω² for a radian.
    """
    value: dict[str, float] = dict(zip(LATERAL.names.reported, (abs(float(v)) for v in theta), strict=True))
    yaw = max(np.sqrt(value["N_beta"]), 1e-6)
    roll = max(value["L_p"], yaw)
    sizes = {"Y_beta": yaw, "Y_p": 1.0, "Y_r": 1.0, "L_p": roll, "L_r": roll, "N_p": yaw, "N_r": yaw}
    sizes |= {"L_beta": max(value["L_beta"], yaw**2), "N_beta": yaw**2}
    for control in ("delta_a", "delta_r"):
        power = max(value[f"L_{control}"], value[f"N_{control}"]) or yaw**2
        sizes |= {f"L_{control}": power, f"N_{control}": power, f"Y_{control}": power / yaw}
    return sizes
