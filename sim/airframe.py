"""Description of an aircraft: mass, geometry and aerodynamic coefficients."""

from dataclasses import astuple, dataclass, fields

import numpy as np
from numpy.typing import NDArray

GRAVITY_M_S2 = 9.80665
"""Standard gravity, m/s²."""

AIR_DENSITY_KG_M3 = 1.225
"""Density of the standard atmosphere at sea level, kg/m³. The bundled aircraft flies at low heights."""


@dataclass(frozen=True)
class Airframe:
    """A rigid aircraft in longitudinal flight with a bank angle.

    Coefficients are non-dimensional, referred to wing area and mean chord. Rates are made dimensionless by
    chord/(2V). Terms beyond the first order are relative to the trimmed ``alpha_ref`` and ``delta_e_ref``.
    """

    mass: float
    """Mass, kg."""
    iyy: float
    """Pitching moment of inertia, kg m²."""
    wing_area: float
    """Wing area, m²."""
    chord: float
    """Mean chord, m."""
    span: float
    """Wing span, m."""
    cl_0: float
    cl_alpha: float
    cl_q: float
    cl_delta_e: float
    cd_0: float
    cd_induced: float
    """Factor of CL² in the drag polar."""
    cm_0: float
    cm_alpha: float
    cm_q: float
    cm_delta_e: float
    thrust_max: float
    """Thrust at full throttle and standstill, N."""
    thrust_zero_speed: float
    """Speed at which the propeller gives no thrust, m/s."""
    roll_rate_max: float
    """Roll rate at full aileron, rad/s."""
    roll_lag: float
    """Time constant of the roll mode, s."""
    alpha_ref: float = 0.0
    delta_e_ref: float = 0.0
    cl_alpha2: float = 0.0
    cl_alpha3: float = 0.0
    stall_alpha: float = 0.0
    """Angle of attack at which half the flow is separated (Kirchhoff), rad; 0 for attached flow."""
    stall_sharpness: float = 0.0
    """Sharpness of the separation over the angle of attack, 1/rad."""
    unsteady_share: float = 0.0
    """Share of lift that builds up with a lag (Wagner's function with one lag)."""
    unsteady_lag: float = 1.0
    """Time constant of the lagging share of lift, s."""
    cm_alpha2: float = 0.0
    cm_alpha3: float = 0.0
    cm_alpha_dot: float = 0.0
    cm_delta_e2: float = 0.0
    cm_delta_e3: float = 0.0
    thrust_arm: float = 0.0
    """Distance of the thrust line below the centre of gravity, m. A positive distance raises the nose."""
    cg_aft: float = 0.0
    """Backward shift of the centre of gravity from the reference of the coefficients, m."""
    ground_lift: float = 0.0
    """Relative increase of lift at the ground, decaying as e^(−h/span)."""
    ground_moment: float = 0.0
    """Added Cm at the ground, decaying as e^(−h/span)."""
    speed_held: float = 0.0
    """Speed hold. With 1 an ideal engine holds the airspeed; with 0 the airspeed follows from the forces."""


AIRFRAME_RECORD = np.dtype([(field.name, np.float64) for field in fields(Airframe)])
"""Memory layout of :class:`Airframe` for compiled code."""

UAV = Airframe(
    mass=10.0,
    iyy=1.10,
    wing_area=0.70,
    chord=0.28,
    span=2.5,
    cl_0=0.22,
    cl_alpha=4.9,
    cl_q=7.0,
    cl_delta_e=0.42,
    cd_0=0.032,
    cd_induced=0.045,
    cm_0=0.030,
    cm_alpha=-0.75,
    cm_q=-11.0,
    cm_delta_e=-1.15,
    thrust_max=60.0,
    thrust_zero_speed=45.0,
    roll_rate_max=3.0,
    roll_lag=0.12,
)
"""A small unmanned aircraft of 10 kg with a pusher propeller, flown at 25 m/s."""

LIGHT_AIRCRAFT = Airframe(
    mass=1200.0,
    iyy=2200.0,
    wing_area=16.2,
    chord=1.5,
    span=11.0,
    cl_0=0.28,
    cl_alpha=4.9,
    cl_q=5.5,
    cl_delta_e=0.42,
    cd_0=0.032,
    cd_induced=0.054,
    cm_0=0.045,
    cm_alpha=-0.75,
    cm_q=-14.0,
    cm_delta_e=-1.20,
    thrust_max=3600.0,
    thrust_zero_speed=110.0,
    roll_rate_max=1.2,
    roll_lag=0.25,
)
"""A four-seat aircraft of 1,200 kg, flown at 55 m/s, with a short period about half as fast."""


def as_record(airframe: Airframe) -> NDArray[np.void]:
    """Return the airframe as a structured array of shape (1,), for compiled code."""
    return np.array([astuple(airframe)], dtype=AIRFRAME_RECORD)
