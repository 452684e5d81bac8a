"""The short-period model, as a linearisation of the nonlinear aircraft and as an aircraft itself."""

from dataclasses import asdict, dataclass

import numpy as np
from numpy.typing import NDArray

from .arrays import FloatArray
from .dynamics import DERIVATIVES, derivatives
from .trim import Trim


@dataclass(frozen=True)
class ShortPeriod:
    """The paper's eight parameters, in rad and s.

    The equations of motion are Eqs. (1)–(2),

        α̇ = Z_0 + Z_α α + (1 + Z_q) q + Z_δe δe
        q̇ = M_0 + M_α α + M_q q + M_δe δe
    """

    Z_0: float
    Z_alpha: float
    Z_q: float
    Z_delta_e: float
    M_0: float
    M_alpha: float
    M_q: float
    M_delta_e: float

    def trim(self) -> tuple[float, float]:
        """Return the angle of attack and the elevator (rad) in equilibrium."""
        matrix = np.array([[self.Z_alpha, self.Z_delta_e], [self.M_alpha, self.M_delta_e]])
        alpha, elevator = np.linalg.solve(matrix, [-self.Z_0, -self.M_0])
        return float(alpha), float(elevator)

    def frequency(self) -> float:
        """Return the undamped natural frequency in rad/s; 0 for an aircraft without a short period."""
        squared = self.Z_alpha * self.M_q - (1 + self.Z_q) * self.M_alpha
        return float(np.sqrt(max(squared, 0.0)))

    def as_dict(self) -> dict[str, float]:
        """Return the eight parameters by name, in the paper's order."""
        return asdict(self)


RESEARCH_JET = ShortPeriod(-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21)
"""Published short-period case of a twin-jet research aircraft in the paper's notation."""


def linearise(record: NDArray[np.void], trim: Trim, width: float = 1e-5) -> ShortPeriod:
    """Return the short-period parameters of the nonlinear aircraft about a trim, by central differences.

    Speed, attitude and height stay at their trimmed values, as in the short-period model. Z_0 and M_0 let the
    linear model trim at the nonlinear aircraft's angle of attack and elevator.
    """

    def rates(index: int | None, by: float, elevator: float) -> FloatArray:
        state, inputs = trim.state(), trim.inputs()
        inputs[0] += elevator
        if index is not None:
            state[index] += by
            if index == 1:
                state[3] += by  # level flight: γ = θ − α stays
                state[7] += by  # slow enough for the late share of lift to have followed
        dx = np.empty(len(DERIVATIVES))
        derivatives(state, inputs, record, dx)
        return dx[1:3]

    by_alpha = (rates(1, width, 0.0) - rates(1, -width, 0.0)) / (2 * width)
    by_q = (rates(2, width, 0.0) - rates(2, -width, 0.0)) / (2 * width)
    by_elevator = (rates(None, 0.0, width) - rates(None, 0.0, -width)) / (2 * width)
    offset = -(by_alpha * trim.alpha + by_elevator * trim.elevator)
    return ShortPeriod(
        float(offset[0]),
        float(by_alpha[0]),
        float(by_q[0] - 1.0),
        float(by_elevator[0]),
        float(offset[1]),
        float(by_alpha[1]),
        float(by_q[1]),
        float(by_elevator[1]),
    )
