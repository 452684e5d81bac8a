"""Level flight in equilibrium, and the linear short-period model about it."""

from dataclasses import asdict, dataclass

import numpy as np
from scipy.optimize import root

from .flight_model import FlightModel
from .kernel import Floats
from .motion import GRAVITY, HEIGHT, LAGGED_ALPHA, STATES, STILL_AIR, THETA, Q, U, W, density, derivatives


@dataclass(frozen=True)
class LinearModel:
    """alpha' = Z_0 + Z_alpha alpha + (1 + Z_q) q + Z_delta_e delta_e and q' = M_0 + ... [SI, rad]."""

    Z_0: float
    Z_alpha: float
    Z_q: float
    Z_delta_e: float
    M_0: float
    M_alpha: float
    M_q: float
    M_delta_e: float

    @property
    def natural_frequency(self) -> float:
        """Undamped short-period frequency [rad/s]."""
        return float(np.sqrt(self.Z_alpha * self.M_q - (1.0 + self.Z_q) * self.M_alpha))

    @property
    def damping_ratio(self) -> float:
        """Short-period damping ratio; above 1 the motion is overdamped."""
        return -(self.Z_alpha + self.M_q) / (2.0 * self.natural_frequency)

    def as_dict(self) -> dict[str, float]:
        """The eight derivatives by name."""
        return asdict(self)

    def response(self, elevator: Floats, step: float) -> tuple[Floats, Floats]:
        """Alpha [rad] and q [rad/s] off trim after an elevator [rad] off trim, held for each step."""
        alpha, rate = np.zeros(len(elevator)), np.zeros(len(elevator))
        system = np.array([[self.Z_alpha, 1.0 + self.Z_q], [self.M_alpha, self.M_q]])
        control = np.array([self.Z_delta_e, self.M_delta_e])
        # The steps are far shorter than the motion: a third-order expansion is exact enough.
        half = np.eye(2) + step / 2.0 * system + (step**2 / 6.0) * system @ system
        transition, gain = np.eye(2) + step * system @ half, step * half @ control
        x = np.zeros(2)
        for k in range(len(elevator) - 1):
            x = transition @ x + gain * elevator[k]
            alpha[k + 1], rate[k + 1] = x
        return alpha, rate


def level_state(model: FlightModel, airspeed: float, alpha: float, height: float) -> Floats:
    """State vector of level flight at an airspeed [m/s], an angle of attack [rad] and a height [m]."""
    state = np.zeros(STATES)
    state[U], state[W] = airspeed * np.cos(alpha), airspeed * np.sin(alpha)
    state[THETA], state[HEIGHT], state[LAGGED_ALPHA] = alpha, height, alpha
    return state


def trimmed(model: FlightModel, height: float) -> FlightModel:
    """The model with the angle of attack, elevator and thrust at which it flies level at its own airspeed."""
    out = np.zeros(STATES)

    def imbalance(unknown: Floats) -> Floats:
        alpha, elevator, thrust_share = unknown
        state = level_state(model, model.airspeed, alpha, height)
        thrust = thrust_share * model.mass * GRAVITY
        derivatives(state, 0.0, elevator, thrust, STILL_AIR, 0.0, model, out)
        return out[[U, W, Q]]

    solution = root(imbalance, np.array([0.03, 0.0, 0.1]), tol=1e-12)
    if np.max(np.abs(solution.fun)) > 1e-8:
        raise ValueError(f"no trim at {model.airspeed} m/s: {solution.message}")
    alpha, elevator, thrust_share = (float(value) for value in solution.x)
    return model._replace(alpha=alpha, elevator=elevator, thrust=thrust_share * model.mass * GRAVITY)


def linearised(model: FlightModel, height: float) -> LinearModel:
    """Dimensional derivatives of a trimmed model without departures (Etkin and Reid, table 4.4)."""
    pressure = 0.5 * density(model.elevation + height) * model.airspeed**2
    force = pressure * model.wing_area / (model.mass * model.airspeed)
    moment = pressure * model.wing_area * model.chord / model.pitch_inertia
    rate = model.chord / (2.0 * model.airspeed)
    thrust = model.thrust * np.cos(model.alpha) / (model.mass * model.airspeed)
    z_alpha, z_delta = -force * model.cl_alpha - thrust, -force * model.cl_delta_e
    m_alpha, m_delta = moment * model.cm_alpha, moment * model.cm_delta_e
    return LinearModel(
        Z_0=-z_alpha * model.alpha - z_delta * model.elevator,
        Z_alpha=z_alpha,
        Z_q=-force * model.cl_q * rate,
        Z_delta_e=z_delta,
        M_0=-m_alpha * model.alpha - m_delta * model.elevator,
        M_alpha=m_alpha,
        M_q=moment * model.cm_q * rate,
        M_delta_e=m_delta,
    )
