"""Seven aircraft as data: dimensions, the flight condition, non-dimensional coefficients.

Coefficients follow the usual conventions (Etkin and Reid, Dynamics of Flight, 3rd edition, chapter 5):
moments about the centre of gravity, pitch rate made non-dimensional with chord / (2 V), elevator positive
trailing edge down.
"""

from dataclasses import dataclass, fields, replace

import numpy as np


@dataclass(frozen=True)
class Aircraft:
    """Dimensions [SI], flight condition [SI] and coefficients [per rad] of one aircraft.

    `elevation_m` is the altitude of the zero of heights; `arm_scale_m` is the distance from the centre of
    gravity at which instruments are usually mounted.
    """

    name: str
    mass_kg: float
    pitch_inertia_kg_m2: float
    wing_area_m2: float
    chord_m: float
    airspeed_m_s: float
    elevation_m: float
    arm_scale_m: float
    cl_0: float
    cl_alpha: float
    cl_q: float
    cl_delta_e: float
    cd_0: float
    induced_drag: float
    cm_0: float
    cm_alpha: float
    cm_q: float
    cm_delta_e: float

    @property
    def span_m(self) -> float:
        """Mean span: area over chord."""
        return self.wing_area_m2 / self.chord_m


COEFFICIENTS = tuple(
    field.name for field in fields(Aircraft) if field.name.startswith(("cl_", "cd_", "cm_", "induced"))
)

# fmt: off
FLEET = (
    # kg, kg m², m², m; m/s, m, m; then the coefficients of lift, drag and moment
    Aircraft("foam uav"      ,    2.4,    0.14, 0.45, 0.22, 16.0,  120.0, 0.35,
             0.16, 4.8, 4.0, 0.32, 0.035, 0.075, 0.035, -0.60, -10.0, -0.90),
    Aircraft("survey uav"    ,   20.0,     3.2,  1.2, 0.42, 27.0,  200.0,  0.8,
             0.20, 5.0, 5.0, 0.38, 0.032, 0.060, 0.030, -0.70, -13.0,  -1.0),
    Aircraft("overdamped uav",   90.0,    38.0,  2.9, 0.55, 38.0,  300.0,  1.2,
             0.22, 5.2, 6.0, 0.40, 0.028, 0.050, 0.010, -0.10, -34.0,  -1.0),
    Aircraft("high drone"    ,  300.0,   300.0,  9.0, 0.70, 60.0, 9000.0,  1.8,
             0.18, 5.4, 3.0, 0.30, 0.022, 0.035, 0.060,  -1.8,  -8.0,  -1.1),
    Aircraft("motor glider"  ,  380.0,   620.0, 11.0, 0.85, 32.0,  600.0,  2.0,
             0.30, 5.6, 6.0, 0.40, 0.020, 0.025, 0.040, -0.75, -16.0,  -1.1),
    Aircraft("light aircraft", 1050.0,  1825.0, 16.2, 1.49, 52.0, 1500.0,  2.5,
             0.28, 4.9, 4.5, 0.40, 0.030, 0.055, 0.020, -0.75, -14.0, -1.15),
    Aircraft("turboprop"     , 4600.0, 24000.0, 26.0, 1.75, 95.0, 3000.0,  5.0,
             0.25, 5.4, 7.0, 0.45, 0.026, 0.040, 0.040,  -1.0, -20.0,  -1.5),
)
# fmt: on
"""The overdamped one has nearly neutral stability and a large tail. The high drone is weakly damped by thin
air and a short tail."""


def scattered(aircraft: Aircraft, rng: np.random.Generator, share: float = 0.2) -> Aircraft:
    """The same aircraft with each coefficient off by at most `share`, so that no two cases are alike."""
    factors = rng.uniform(1.0 - share, 1.0 + share, len(COEFFICIENTS))
    changed = {
        name: getattr(aircraft, name) * float(f) for name, f in zip(COEFFICIENTS, factors, strict=True)
    }
    return replace(aircraft, **changed)
