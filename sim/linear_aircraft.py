"""The paper's linear model as an aircraft: eight parameters, optionally with further effects.

The motion has constant V. So γ = θ − α, and the specific forces follow from kinematics alone,

    a_z = V cos α (α̇ − q) + V̇ sin α − g cos θ,   a_x = −V sin α (α̇ − q) + V̇ cos α + g sin θ.
"""

import math
from dataclasses import astuple, dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.process.compiled import kernel

from .airframe import GRAVITY_M_S2
from .linear import ShortPeriod
from .motion import Controls, Motion
from .servo import Calibration

ROLL_RATE_MAX = 2.0
ROLL_LAG_S = 0.15


@dataclass(frozen=True)
class LinearTerms:
    """Terms in addition to the eight parameters; all zero for the paper's model. Rad, s and m."""

    Z_alpha2: float = 0.0
    Z_alpha3: float = 0.0
    M_alpha2: float = 0.0
    M_alpha3: float = 0.0
    M_delta2: float = 0.0
    M_delta3: float = 0.0
    M_alpha_dot: float = 0.0
    M_throttle: float = 0.0
    """Pitch acceleration per unit of throttle away from trim, rad/s²."""
    throttle_lag: float = 0.0
    """Lag of the engine behind its throttle, s. 0: no lag."""
    M_thrust: float = 0.0
    """Contribution of the thrust to the trimmed moment, rad/s², which does not grow with dynamic pressure."""
    washed_share: float = 0.0
    """Share of the elevator's effectiveness in the propeller's slipstream, which does not grow with dynamic
    pressure."""
    blown_share: float = 0.0
    """Growth of the elevator's effectiveness with the excess of thrust over drag, per unit of weight."""
    unsteady_share: float = 0.0
    unsteady_lag: float = 1.0
    unsteady_moment: float = 0.0
    """1: the moment builds up with the lift. 0: the moment follows the angle of attack at once."""
    stall_alpha: float = 0.0
    """Angle of attack at which half the flow has separated (Kirchhoff), rad."""
    stall_sharpness: float = 0.0
    """Sharpness of the separation, 1/rad. 0: the flow always stays attached."""
    Z_h: float = 0.0
    """Z_0 added at the ground, 1/s, decaying as e^(−h / ground_scale)."""
    lift_h: float = 0.0
    """Relative gain of all lift at the ground, decaying as e^(−h / ground_scale)."""
    M_h: float = 0.0
    ground_scale: float = 1.0
    speed_scaled: float = 0.0
    """1: derivatives change with airspeed, and gravity turns with the flight path. 0: constant."""
    speed_power: float = 0.0
    """Power of V beyond that of dynamic pressure, for lift and moments due to angles."""
    moment_power: float = 0.0
    """Power of V of the moments beyond that of the lift."""
    gravity: float = 0.0
    """1: gravity turns with the flight path, (g/V)(cos γ − 1) in α̇."""


MODEL_RECORD = np.dtype(
    [(f.name, np.float64) for f in fields(ShortPeriod)]
    + [(f.name, np.float64) for f in fields(LinearTerms)]
    + [
        ("alpha_ref", np.float64),
        ("delta_ref", np.float64),
        # Angles about which the squares and cubes of lift, moment and elevator are taken.
        ("Z_about", np.float64),
        ("M_about", np.float64),
        ("delta_about", np.float64),
        ("throttle_ref", np.float64),
        ("speed_ref", np.float64),
    ]
)


@kernel()
def _bent(angle: float, trimmed: float, about: float, square: float, cube: float) -> float:
    """Return the square and cube of an angle about another, less their values at the trim, which Z_0 and M_0
    contain."""
    off, usual = angle - about, trimmed - about
    return square * (off**2 - usual**2) + cube * (off**3 - usual**3)


@kernel()
def rates(x: NDArray[np.float64], u: NDArray[np.float64], model: Any, dx: NDArray[np.float64]) -> None:
    """Fill ``dx`` from x = [α, q, θ, h, φ, p, α_late, P_late] and u = [δe, P, aileron, w, V, ΔZ, ΔM, V̇].

    P is the throttle, and P_late its value after the engine's lag.
    """
    m = model[0]
    alpha, q, theta, height, phi, p, late = x[0], x[1], x[2], x[3], x[4], x[5], x[6]
    throttle = x[7] if m.throttle_lag > 0.0 else u[1]
    elevator, speed = u[0], u[4]
    air = alpha + u[3] / speed
    behind = m.unsteady_share * (air - late)
    lifting, turning = air - behind, air - m.unsteady_moment * behind
    off_elevator = elevator - m.delta_ref
    gamma = theta - alpha
    ratio, power, turn, weight, gravity = 1.0, 1.0, 1.0, GRAVITY_M_S2 / m.speed_ref, 0.0
    wing = m.Z_0 - weight + m.Z_alpha * lifting
    if m.speed_scaled > 0.0:
        ratio, weight = speed / m.speed_ref, GRAVITY_M_S2 / speed
        power, turn = ratio**m.speed_power, ratio**m.moment_power
    if m.stall_sharpness > 0.0:
        stalled = 0.5 * (1.0 + math.tanh(m.stall_sharpness * (air - m.stall_alpha)))
        wing *= ((1.0 + math.sqrt(1.0 - stalled)) / 2.0) ** 2
    if m.gravity > 0.0:
        gravity = GRAVITY_M_S2 / speed * (math.cos(gamma) * math.cos(phi) - 1.0)
    ground = 0.0
    if m.Z_h != 0.0 or m.M_h != 0.0 or m.lift_h != 0.0:
        ground = math.exp(-max(height, 0.0) / m.ground_scale)
    alpha_dot = (
        weight
        + gravity
        + ratio
        * power
        * (
            (wing + m.Z_delta_e * elevator + _bent(air, m.alpha_ref, m.Z_about, m.Z_alpha2, m.Z_alpha3))
            * (1.0 + m.lift_h * ground)
            + m.Z_h * ground
        )
        + (1.0 + m.Z_q) * q
        + u[5]
    )
    q_dot = (
        ratio * (m.M_q * q + m.M_alpha_dot * alpha_dot)
        + ratio**2
        * power
        * turn
        * (
            m.M_0
            + m.M_alpha * turning
            + m.M_delta_e * elevator
            + _bent(air, m.alpha_ref, m.M_about, m.M_alpha2, m.M_alpha3)
            + _bent(elevator, m.delta_ref, m.delta_about, m.M_delta2, m.M_delta3)
            + m.M_h * ground
        )
        + m.M_throttle * (throttle - m.throttle_ref)
        + (m.M_thrust + power * m.washed_share * m.M_delta_e * off_elevator) * (1.0 - ratio**2)
        + power * m.blown_share * m.M_delta_e * off_elevator * (u[7] / GRAVITY_M_S2 + math.sin(gamma))
        + u[6]
    )
    dx[0] = alpha_dot
    dx[1] = q_dot
    dx[2] = q
    dx[3] = speed * math.sin(gamma)
    dx[4] = p
    dx[5] = (u[2] * ROLL_RATE_MAX - p) / ROLL_LAG_S
    dx[6] = (air - late) / m.unsteady_lag
    dx[7] = (u[1] - x[7]) / m.throttle_lag if m.throttle_lag > 0.0 else 0.0


@kernel()
def step(
    x: NDArray[np.float64],
    u_from: NDArray[np.float64],
    u_to: NDArray[np.float64],
    model: Any,
    dt: float,
    dx: NDArray[np.float64],
) -> None:
    """Advance ``x`` by ``dt`` (classical Runge–Kutta, inputs linear); ``dx`` is then the rates there."""
    u_mid = 0.5 * (u_from + u_to)
    k1, k2, k3, k4 = np.empty_like(x), np.empty_like(x), np.empty_like(x), np.empty_like(x)
    rates(x, u_from, model, k1)
    rates(x + 0.5 * dt * k1, u_mid, model, k2)
    rates(x + 0.5 * dt * k2, u_mid, model, k3)
    rates(x + dt * k3, u_to, model, k4)
    x += dt / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4)
    rates(x, u_to, model, dx)


class LinearAircraft:
    """An engine (see :class:`sim.motion.Engine`) flying Eqs. (1)–(2)."""

    def __init__(
        self,
        model: ShortPeriod,
        airspeed_m_s: float,
        height_m: float,
        terms: LinearTerms | None = None,
        throttle: float = 0.5,
    ) -> None:
        terms = terms or LinearTerms()
        alpha, elevator = model.trim()
        self.truth = model
        self.record: NDArray[np.void] = np.array(
            [
                (
                    *astuple(model), *astuple(terms), alpha, elevator, alpha, alpha, elevator,
                    throttle, airspeed_m_s,
                )
            ],
            dtype=MODEL_RECORD,
        )  # fmt: skip
        """Model being flown. Effects may change its fields in flight."""
        self.calibration = Calibration()
        self.trim = Controls(elevator, throttle, 0.0)
        self.airspeed = airspeed_m_s
        """Airspeed, m/s. Constant unless an effect or a replayed record changes it."""
        self.airspeed_dot = 0.0
        self._state = np.array([alpha, 0.0, alpha, height_m, 0.0, 0.0, alpha, throttle])
        self._inputs = np.array([elevator, throttle, 0.0, 0.0, airspeed_m_s, 0.0, 0.0, 0.0])
        self._before = self._inputs.copy()
        self._rates = np.empty_like(self._state)
        rates(self._state, self._inputs, self.record, self._rates)

    def motion(self) -> Motion:
        """Return the motion now."""
        alpha, q, theta, height, phi, p, _, _ = self._state.tolist()
        alpha_dot, q_dot, _, climb, _, _, _, _ = self._rates.tolist()
        elevator, throttle, _, gust_up, speed, _, _, _ = self._inputs.tolist()
        turning = speed * (alpha_dot - q)
        along = self.airspeed_dot
        sin_a, cos_a = math.sin(alpha), math.cos(alpha)
        return Motion(
            speed,
            alpha,
            q,
            theta,
            height,
            phi,
            p,
            climb,
            along,
            alpha_dot,
            q_dot,
            -turning * sin_a + along * cos_a + GRAVITY_M_S2 * math.sin(theta),
            turning * cos_a + along * sin_a - GRAVITY_M_S2 * math.cos(theta) * math.cos(phi),
            elevator,
            throttle,
            gust_up,
            0.0,
        )

    def step(self, controls: Controls, dt: float) -> Motion:
        """Fly for ``dt`` seconds and return the resulting motion.

        ``extra_cl`` and ``extra_cm`` are added α̇ in rad/s and q̇ in rad/s².
        """
        self._before, self._inputs = self._inputs, self._before
        elevator, throttle, aileron, gust_up, _, extra_z, extra_m = controls[:7]
        self._inputs[:] = (
            elevator, throttle, aileron, gust_up, self.airspeed, extra_z, extra_m, self.airspeed_dot
        )  # fmt: skip
        step(self._state, self._before, self._inputs, self.record, dt, self._rates)
        return self.motion()
