"""Modes of the lateral motion from an estimate, with 95 % intervals by the delta method.

Let λ be a simple eigenvalue of A with right and left eigenvectors v and w. A change dA of the matrix changes
it by dλ = wᵀ·dA·v/(wᵀ·v) (Wilkinson, *The Algebraic Eigenvalue Problem*, 1965, ch. 2). The Dutch roll has the
frequency ω = |λ| and the damping ζ = -Re λ/ω, and the roll mode has the time constant -1/λ.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.lateral import LATERAL, Trim, modes_of, state_matrix
from advisor.oem.flying_qualities import Quality

_STATES = len(LATERAL.states)


@dataclass(frozen=True, slots=True)
class LateralModes:
    """Modes of an estimate; an absent one has its reason in ``left_out``."""

    dutch_roll_omega: Quality | None
    """Undamped natural frequency of the Dutch roll, rad/s."""
    dutch_roll_zeta: Quality | None
    """Damping ratio of the Dutch roll."""
    roll_time_constant: Quality | None
    """Time constant of the roll mode, s."""
    spiral_pole: Quality | None
    """Eigenvalue of the spiral, 1/s; positive where the spiral diverges."""
    left_out: Mapping[str, str] = field(default_factory=dict)


def lateral_modes(theta: FloatArray, covariance: FloatArray, trim: Trim) -> LateralModes:
    """Return the modes at the trim of ``theta`` (15,), with errors by its covariance (15, 15)."""
    a = state_matrix(theta, trim)
    found = modes_of(a)
    omega = zeta = roll = spiral = None
    left_out: dict[str, str] = {}
    if found.dutch_roll is None:
        left_out["dutch_roll"] = "the aircraft has no oscillation in yaw at these values"
    else:
        value = found.dutch_roll
        slope = _slope(a, value)
        size = abs(value)
        by_size = (value.conjugate() * slope).real / size
        by_damping = -slope.real / size + value.real * by_size / size**2
        omega = _quality(size, by_size, covariance)
        zeta = _quality(-value.real / size, by_damping, covariance)
    if found.roll is None or found.spiral is None:
        left_out["roll"] = left_out["spiral"] = "roll and spiral oscillate together at these values"
    else:
        roll = _quality(-1.0 / found.roll, _slope(a, found.roll).real / found.roll**2, covariance)
        spiral = _quality(found.spiral, _slope(a, found.spiral).real, covariance)
    return LateralModes(omega, zeta, roll, spiral, left_out)


def _slope(a: FloatArray, value: complex) -> np.ndarray:
    """Return the derivatives of an eigenvalue of ``a`` by the 15 derivatives."""
    values, right = np.linalg.eig(a)
    k = int(np.argmin(np.abs(values - value)))
    left = np.linalg.inv(right)[k]
    moved = np.zeros(len(LATERAL.shared), np.complex128)
    for j, (row, column, _) in enumerate(LATERAL.place[: len(LATERAL.shared)]):
        if column < _STATES:
            moved[j] = left[row] * right[column, k]
    return moved


def _quality(value: float, slope: FloatArray, covariance: FloatArray) -> Quality:
    variance = float(slope @ covariance @ slope)
    return Quality(float(value), max(variance, 0.0) ** 0.5)
