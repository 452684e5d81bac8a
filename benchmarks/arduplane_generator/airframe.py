"""Drawn airframes of ArduPlane's simulated plane, and the true derivatives by that plane's formulas.

The formulas are those of ``libraries/SITL/SIM_Plane.cpp``. The plane weighs 2 kg, its angular acceleration is
the aerodynamic moment itself, and a control of 1 is a pulse of 500 us. A heavier aircraft is drawn by forces
that are smaller by 2 kg over its mass, drag included.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from benchmarks.ardupilot_plane import GRAVITY, MASS_KG, SKYWALKER

DENSITY = 1.225
"""Air density of the simulated plane, kg/m³, at every height."""
FULL_RAD = float(np.radians(25.0))
"""Deflection at a control of 1, rad, as the aircraft file states it."""
THRUST_N = 28.0
"""Static thrust at full throttle, N."""
_LIFT = ("c_lift_0", "c_lift_a", "c_lift_q", "c_lift_deltae")
_FORCES = (*_LIFT, "c_drag_p", "oswald", "c_y_b", "c_y_deltar")


@dataclass(frozen=True)
class Airframe:
    """One drawn airframe, with the trim in level flight at one true air speed."""

    coefficients: Mapping[str, float]
    """Coefficients for the file that PLANE_COEFFICIENTS names, for 2 kg."""
    mass_kg: float
    """Mass of the aircraft that the coefficients describe."""
    speed_m_s: float
    """True air speed of the trim, m/s."""

    @cached_property
    def all(self) -> dict[str, float]:
        """Coefficients with the stock plane's where none is drawn."""
        return SKYWALKER | dict(self.coefficients)

    @property
    def alpha(self) -> float:
        """Angle of attack of the trim, rad."""
        needed = MASS_KG * GRAVITY / self._pressure(self.speed_m_s)
        return (needed - self.all["c_lift_0"]) / self.all["c_lift_a"]

    @property
    def throttle(self) -> float:
        """Throttle of the trim, 0 to 1."""
        c = self.all
        lift = c["c_lift_0"] + c["c_lift_a"] * self.alpha
        drag = c["c_drag_p"] + lift**2 / (np.pi * c["oswald"] * c["b"] ** 2 / c["s"])
        return self._pressure(self.speed_m_s) * drag / THRUST_N

    def derivatives(self, speed_m_s: float) -> dict[str, float]:
        """Return the derivatives of both axes at a true air speed, rad and s, with the contract's signs."""
        c, v = self.all, speed_m_s
        force = self._pressure(v) / (MASS_KG * v)
        moment, wide = self._pressure(v) * c["c"], self._pressure(v) * c["b"]
        long, span = c["c"] / (2.0 * v), c["b"] / (2.0 * v)
        thrust = self.throttle * THRUST_N / (MASS_KG * v)
        z_alpha = -force * c["c_lift_a"] - thrust
        m_alpha = moment * c["c_m_a"]
        # A pulse above the middle raises the nose, rolls and yaws to the right: negative deflections.
        told = {
            "Z_alpha": z_alpha, "Z_q": -force * c["c_lift_q"] * long,
            "Z_delta_e": force * c["c_lift_deltae"] / FULL_RAD,
            "M_alpha": m_alpha, "M_q": moment * c["c_m_q"] * long,
            "M_delta_e": -moment * c["c_m_deltae"] / FULL_RAD,
            "Z_0": -z_alpha * self.alpha, "M_0": -m_alpha * self.alpha,
            "Y_beta": force * c["c_y_b"], "Y_p": 0.0, "Y_r": 0.0, "Y_delta_a": 0.0,
            "Y_delta_r": -force * c["c_y_deltar"] / FULL_RAD,
        }  # fmt: skip
        for letter, name in (("L", "l"), ("N", "n")):
            told[f"{letter}_beta"] = wide * c[f"c_{name}_b"]
            told[f"{letter}_p"] = wide * c[f"c_{name}_p"] * span
            told[f"{letter}_r"] = wide * c[f"c_{name}_r"] * span
            told[f"{letter}_delta_a"] = -wide * c[f"c_{name}_deltaa"] / FULL_RAD
            told[f"{letter}_delta_r"] = -wide * c[f"c_{name}_deltar"] / FULL_RAD
        return {name: float(value) for name, value in told.items()}

    def _pressure(self, speed_m_s: float) -> float:
        return 0.5 * DENSITY * speed_m_s**2 * self.all["s"]


def draw_airframe(rng: np.random.Generator) -> Airframe:
    """Draw an airframe of 2 to 6 kg that is in trim with free controls, light model to stock plane."""
    u = rng.uniform
    mass, speed = float(u(2.0, 6.0)), float(u(19.0, 24.0))
    lighter = MASS_KG / mass
    drawn = {
        "c_lift_0": u(0.2, 0.5), "c_lift_a": u(4.5, 6.9), "c_drag_p": u(0.05, 0.1), "oswald": 0.9,
        "c_y_b": u(-1.2, -0.6), "c_y_deltar": u(-0.25, -0.1),
        "c_m_a": u(-2.6, -0.9), "c_m_q": u(-24.0, -9.0), "c_m_deltae": u(0.8, 1.5),
        "c_l_b": u(-0.12, -0.04), "c_l_p": u(-1.0, -0.5), "c_l_r": u(0.08, 0.2),
        "c_l_deltaa": u(0.14, 0.26), "c_l_deltar": u(-0.037, -0.01),
        "c_n_b": u(0.06, 0.16), "c_n_p": u(-0.05, 0.022), "c_n_r": u(-0.5, -0.2),
        "c_n_deltaa": u(-0.02, 0.0), "c_n_deltar": u(0.05, 0.1),
        "CGOffset_x": 0.0, "CGOffset_y": 0.0, "CGOffset_z": 0.0,
    }  # fmt: skip
    drawn |= {name: drawn[name] * lighter for name in _FORCES if name in drawn}
    free = Airframe({name: float(value) for name, value in drawn.items()}, mass, speed)
    trimmed = dict(free.coefficients, c_m_0=-free.all["c_m_a"] * free.alpha)
    return Airframe(trimmed, mass, speed)
