"""The paper's linear model as an aircraft: eight parameters, optionally with further effects.

The motion has constant V. The flight-path angle is γ = θ − α, and the specific forces follow from kinematics
alone,

    a_z = V cos α (α̇ − q) + V̇ sin α − g cos θ,   a_x = −V sin α (α̇ − q) + V̇ cos α + g sin θ.
"""

import math
from dataclasses import astuple, dataclass, fields

import numpy as np
from numpy.typing import NDArray

from .airframe import GRAVITY_M_S2
from .linear import ShortPeriod
from .linear_motion import rates, step
from .motion import Controls, Motion
from .servo import Calibration


@dataclass(frozen=True)
class LinearTerms:
    """Terms in addition to the eight parameters, all zero in the paper's model. Units are rad, s and m."""

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
    """Lag of the engine behind its throttle, s; 0 for no lag."""
    M_thrust: float = 0.0
    """Thrust part of the trimmed moment, rad/s², which does not grow with dynamic pressure."""
    washed_share: float = 0.0
    """Share of the elevator's effectiveness in the propeller's slipstream, which does not grow with dynamic
    pressure."""
    blown_share: float = 0.0
    """Increase of the elevator's effectiveness by thrust minus drag, per unit of weight."""
    unsteady_share: float = 0.0
    unsteady_lag: float = 1.0
    unsteady_moment: float = 0.0
    """Lift lag in the moment: with 1 the moment lags like the lift, with 0 it follows α at once."""
    stall_alpha: float = 0.0
    """Angle of attack at which half the flow has separated (Kirchhoff), rad."""
    stall_sharpness: float = 0.0
    """Sharpness of the flow separation, 1/rad; 0 for attached flow."""
    Z_h: float = 0.0
    """Z_0 added at the ground, 1/s, decaying as e^(−h / ground_scale)."""
    lift_h: float = 0.0
    """Relative gain of all lift at the ground, decaying as e^(−h / ground_scale)."""
    M_h: float = 0.0
    ground_scale: float = 1.0
    speed_scaled: float = 0.0
    """Speed scaling. With 1 derivatives change with airspeed, and gravity turns with the path; with 0 neither
    does.
    """
    speed_power: float = 0.0
    """Power of V beyond that of dynamic pressure, for lift and moments due to angles."""
    moment_power: float = 0.0
    """Power of V of the moments beyond that of the lift."""
    gravity: float = 0.0
    """Gravity term: with 1 gravity turns with the flight path, (g/V)(cos γ − 1) in α̇."""


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
        """Model that is flown. Effects may change its fields in flight."""
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
