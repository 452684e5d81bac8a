"""The short-period model of Eqs. (1)-(3): its matrices and frequency.

    α̇ = Z_0 + Z_α·α + (1 + Z_q)·q + Z_δe·δe          (1)
    q̇ = M_0 + M_α·α + M_q·q + M_δe·δe                (2)

States are angle of attack α and pitch rate q, the input is the elevator deflection δe
(positive trailing edge down). Everything is in rad and s.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.model.axis import Names
from advisor.model.outputs import LOCAL, OUTPUTS, SHARED
from advisor.process.arrays import FloatArray

NAMES = Names(OUTPUTS, SHARED, LOCAL, PARAMETERS)
"""Names of the short-period model's outputs and parameters. Z_0 and M_0 are reported as means over the
manoeuvres."""


@dataclass(frozen=True, slots=True)
class ShortPeriod:
    """The eight parameters of Eq. (3) as matrices of ẋ = A·x + B·δe + c."""

    theta: FloatArray
    """Shape (8,), order of ``PARAMETERS``."""

    @classmethod
    def from_mapping(cls, values: Mapping[str, float]) -> "ShortPeriod":
        """Return the model from parameters by name; a missing parameter is zero."""
        return cls(np.array([float(values.get(name, 0.0)) for name in PARAMETERS]))

    @property
    def a(self) -> FloatArray:
        """Shape (2, 2). State matrix A."""
        t = self.theta
        return np.array([[t[1], 1.0 + t[2]], [t[5], t[6]]])

    @property
    def b(self) -> FloatArray:
        """Shape (2,). Input matrix B."""
        return self.theta[[3, 7]]

    @property
    def c(self) -> FloatArray:
        """Shape (2,). Constants Z_0 and M_0."""
        return self.theta[[0, 4]]

    @property
    def natural_frequency(self) -> float:
        """Undamped natural frequency √det A in rad/s; NaN when statically unstable (det A < 0)."""
        stiffness = float(np.linalg.det(self.a))
        return math.sqrt(stiffness) if stiffness >= 0.0 else math.nan

    @property
    def eigenvalues(self) -> tuple[complex, complex]:
        """Both eigenvalues of A in 1/s."""
        first, second = np.linalg.eigvals(self.a)
        return complex(first), complex(second)
