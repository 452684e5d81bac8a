"""Level flight: angle of attack, elevator and throttle with zero accelerations."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .dynamics import DERIVATIVES, derivatives


class TrimError(ValueError):
    """No level flight exists for this aircraft at this speed and height."""


@dataclass(frozen=True)
class Trim:
    """An equilibrium state of level flight."""

    airspeed: float
    alpha: float
    elevator: float
    throttle: float
    height: float

    def state(self) -> NDArray[np.float64]:
        """Return the state vector :data:`sim.dynamics.STATES` in level flight, with θ = α."""
        return np.array([self.airspeed, self.alpha, 0.0, self.alpha, self.height, 0.0, 0.0, self.alpha])

    def inputs(self) -> NDArray[np.float64]:
        """Return the input vector :data:`sim.dynamics.INPUTS` of level flight."""
        return np.array([self.elevator, self.throttle, 0.0, 0.0, 0.0, 0.0, 0.0])


def trim_level(record: NDArray[np.void], airspeed: float, height: float) -> Trim:
    """Return the trim of an airframe in straight level flight, by Newton's method on (V̇, α̇, q̇).

    Parameters
    ----------
    record
        Airframe from :func:`sim.airframe.as_record`, including every effect.
    airspeed, height
        Airspeed in m/s and height in m.

    Raises
    ------
    TrimError
        The aircraft cannot fly level, because the required throttle is outside 0..1, or no solution exists.
    """
    free = record.copy()
    free["speed_held"] = 0.0

    def residual(unknown: NDArray[np.float64]) -> NDArray[np.float64]:
        alpha, elevator, throttle = unknown
        trim = Trim(airspeed, alpha, elevator, throttle, height)
        dx = np.empty(len(DERIVATIVES))
        derivatives(trim.state(), trim.inputs(), free, dx)
        return dx[:3]

    unknown = np.array([0.05, 0.0, 0.3])
    for _ in range(50):
        error = residual(unknown)
        if np.abs(error).max() < 1e-12:
            break
        jacobian = np.empty((3, 3))
        for i, width in enumerate((1e-6, 1e-6, 1e-6)):
            shift = np.zeros(3)
            shift[i] = width
            jacobian[:, i] = (residual(unknown + shift) - residual(unknown - shift)) / (2 * width)
        unknown = unknown - np.linalg.solve(jacobian, error)
    alpha, elevator, throttle = (float(value) for value in unknown)
    if not np.abs(residual(unknown)).max() < 1e-9 or not 0.0 <= throttle <= 1.0 or abs(alpha) > 0.4:
        raise TrimError(f"no level flight at {airspeed:g} m/s: choose another airspeed_m_s")
    return Trim(airspeed, alpha, elevator, throttle, height)
