"""Eight parameters as a simulator: Eqs. (1)-(2) about a trim, with exact kinematics, in still air."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.gap.simulator.surface import above_start
from advisor.process.arrays import FloatArray
from advisor.simulators.protocol import Condition, Increments, Inputs, Replay, State

_FARTHEST_RAD = 1.5
"""Angle of attack, rad, at which the simulation stops."""
_Motion = tuple[float, float, float]
"""Values of α (rad), q (rad/s) and θ (rad)."""


@dataclass(frozen=True)
class LinearSimulator:
    """Simulator of short-period derivatives at a reference speed, which scale with the speed."""

    derivatives: Mapping[str, float]
    """Derivatives Z_alpha, Z_q, Z_delta_e, M_alpha, M_q, M_delta_e."""
    reference_m_s: float | None = None
    """Air speed of the derivatives, m/s; None for the flown speed."""
    description: str = "the aircraft file's model"
    takes_increments: bool = True
    takes: frozenset[str] = frozenset()
    speed_limit_s: float = np.inf

    def replay(self, condition: Condition, inputs: Inputs, increments: Increments | None = None) -> Replay:
        """Fly the inputs from trim at constant speed, by the steps of the gap's own simulation."""
        n, h = len(inputs.t), float(inputs.t[1] - inputs.t[0])
        speed, steep = condition.airspeed_m_s, condition.flight_path_rad
        elevator = inputs.elevator.tolist()
        throttle = np.asarray(inputs.others.get("throttle", np.zeros(n))).tolist()
        rates = self._rates(speed, steep)
        # The specific force belongs to the start of a step, the deflection is the mean over the step.
        ahead = (rates[2] * above_start(np.ascontiguousarray(inputs.elevator))).tolist()
        x: _Motion = (0.0, 0.0, steep)
        height = condition.height_m
        rows = np.empty((n + 1, 5))
        for i in range(n + 1):
            j = min(i, n - 1)
            weight = rates[6] * cos(x[2] - x[0])
            now = State(i * h, x[0], 0.0, x[1], elevator[j], speed, height, throttle[j])
            normal, k = _step(rates, now, weight, increments)
            rows[i] = (*x, speed * (normal - ahead[j]), height)
            middle = replace(now, t=(i + 0.5) * h, alpha=x[0] + 0.5 * h * k[0], q=x[1] + 0.5 * h * k[1])
            _, k = _step(rates, middle, weight, increments)
            height += h * speed * sin(x[2] - x[0])
            alpha = min(max(x[0] + h * k[0], -_FARTHEST_RAD), _FARTHEST_RAD)
            x = (alpha, x[1] + h * k[1], x[2] + h * (x[1] + 0.5 * h * k[1]))
        angle, rate, attitude, pull, heights = rows.T
        a_x = np.full(n + 1, GRAVITY_M_S2 * sin(steep))
        a_z = (pull + a_x * np.sin(angle)) / np.cos(angle)
        t: FloatArray = np.arange(n + 1, dtype=np.float64) * h
        return Replay(t, angle, rate, attitude, a_z, np.full(n + 1, speed), heights, a_x)

    def linearise(self, condition: Condition) -> Mapping[str, float]:
        """Return the six derivatives at the condition's speed."""
        v = 1.0 if self.reference_m_s is None else condition.airspeed_m_s / self.reference_m_s
        powers = dict(zip(DERIVATIVES, (1, 0, 1, 2, 1, 2), strict=True))
        return {name: self.derivatives[name] * v ** powers[name] for name in DERIVATIVES}

    def close(self) -> None:
        """Do nothing, because no process runs."""

    def _rates(self, speed: float, steep: float) -> FloatArray:
        """Return six derivatives at the speed, g/V, and the lift that balances the weight."""
        here = self.linearise(Condition(speed))
        weight = GRAVITY_M_S2 / speed
        return np.array([*(here[name] for name in DERIVATIVES), weight, -weight * np.cos(steep)])


def _step(
    rates: FloatArray, now: State, weight: float, increments: Increments | None
) -> tuple[float, tuple[float, float]]:
    """Return the normal force over m·V, rad/s, and the rates of α and q from ``rates`` (8,)."""
    z_alpha, z_q, z_delta, m_alpha, m_q, m_delta, _, level = rates.tolist()
    normal = level + z_alpha * now.alpha + z_q * now.q + z_delta * now.elevator
    alpha_dot = now.q + weight + normal
    q_dot = m_alpha * now.alpha + m_q * now.q + m_delta * now.elevator
    if increments is not None:
        force, moment = increments(replace(now, alpha_dot=alpha_dot))
        normal, alpha_dot, q_dot = normal + force, alpha_dot + force, q_dot + moment
    return normal, (alpha_dot, q_dot)
