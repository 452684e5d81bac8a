"""Six aircraft, and the numbers that the equations of motion take from their geometry."""

from dataclasses import dataclass, fields
from typing import NamedTuple

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

Floats = NDArray[np.float64]

GRAVITY_M_S2 = 9.80665
STRIPS = 7


@dataclass(frozen=True)
class Aircraft:
    """What a manufacturer would print, SI units; angles in rad."""

    name: str
    mass_kg: float
    span_m: float
    wing_area_m2: float
    taper: float
    washout_rad: float
    sweep_rad: float
    gyration_radius_m: float
    static_margin: float
    tail_arm_m: float
    tail_area_m2: float
    tail_aspect: float
    flap_effectiveness: float
    fuselage_slope: float
    zero_lift_drag: float
    largest_section_lift: float
    thrust_fall: float
    airspeed_m_s: float
    height_m: float
    elevator_reach_rad: float

    @property
    def chord_m(self) -> float:
        """Mean chord."""
        return self.wing_area_m2 / self.span_m

    @property
    def aspect(self) -> float:
        """Aspect ratio of the wing."""
        return self.span_m**2 / self.wing_area_m2

    @property
    def density_kg_m3(self) -> float:
        """Standard atmosphere at the height of flight."""
        return float(1.225 * (1.0 - 2.25577e-5 * self.height_m) ** 4.2559)

    @property
    def pitch_inertia_kg_m2(self) -> float:
        """Moment of inertia about the pitch axis."""
        return self.mass_kg * self.gyration_radius_m**2


# fmt: off
FLEET = (
    Aircraft("foam 3 kg", 3.0, 1.9, 0.48, 0.7, 0.02, 0.0, 0.27, 0.16, 0.78,
             0.085, 4.0, 0.50, 0.15, 0.034, 1.35, 0.75, 17.0, 150.0, 0.42),
    Aircraft("survey 14 kg", 14.0, 3.1, 0.92, 0.6, 0.03, 0.0, 0.46, 0.20, 1.28,
             0.155, 4.4, 0.46, 0.12, 0.029, 1.40, 0.70, 26.0, 250.0, 0.40),
    Aircraft("target jet 70 kg", 70.0, 2.6, 0.95, 0.5, 0.02, 0.35, 0.72, 0.18, 1.35,
             0.22, 3.2, 0.55, 0.25, 0.026, 1.30, 0.12, 72.0, 600.0, 0.35),
    Aircraft("motor glider 640 kg", 640.0, 16.2, 15.6, 0.45, 0.035, 0.0, 1.45, 0.19, 4.6,
             1.75, 5.2, 0.44, 0.22, 0.015, 1.45, 0.65, 33.0, 900.0, 0.38),
    Aircraft("trainer 1050 kg", 1050.0, 10.4, 15.2, 0.75, 0.03, 0.0, 1.30, 0.17, 4.4,
             3.0, 4.0, 0.48, 0.28, 0.029, 1.50, 0.60, 53.0, 1200.0, 0.40),
    Aircraft("business jet 7.6 t", 7600.0, 15.3, 29.5, 0.35, 0.04, 0.30, 3.10, 0.22, 7.2,
             6.6, 4.3, 0.50, 0.45, 0.021, 1.40, 0.10, 135.0, 4500.0, 0.33),
)
# fmt: on

SCATTERED = (
    "gyration_radius_m",
    "static_margin",
    "tail_area_m2",
    "flap_effectiveness",
    "fuselage_slope",
    "airspeed_m_s",
)


def scattered(aircraft: Aircraft, rng: Generator) -> Aircraft:
    """An aircraft of the same type and other numbers: six of them within 12 %."""
    values = {item.name: getattr(aircraft, item.name) for item in fields(aircraft)}
    for name in SCATTERED:
        values[name] *= float(rng.uniform(0.88, 1.12))
    return Aircraft(**values)


class Shape(NamedTuple):
    """What the equations of motion need; lengths from the file's centre of gravity, positive aft."""

    mass: float
    inertia: float
    density: float
    area: float
    span: float
    chord: float
    strip_area: Floats
    strip_x: Floats
    strip_twist: Floats
    strip_share: Floats
    wing_slope: float
    section_limit: float
    induced: float
    drag_0: float
    tail_x: float
    tail_area: float
    tail_slope: float
    tail_setting: float
    flap: float
    downwash: float
    fuselage: float
    thrust_0: float
    thrust_fall: float
    speed_0: float


def slope(aspect: float) -> float:
    """Lift-curve slope of a wing of finite span [1/rad] (Helmbold, 1942)."""
    return float(2.0 * np.pi * aspect / (2.0 + np.sqrt(4.0 + aspect**2)))


def shape(aircraft: Aircraft, tail_setting: float = 0.0) -> Shape:
    """Cut the wing into strips, load them after Schrenk, and place the wing for the static margin.

    Schrenk (NACA TM 948, 1940): a strip's lift is the mean of its share by chord and of an elliptic share.
    """
    edges = np.linspace(0.0, 1.0, STRIPS + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    root = 2.0 * aircraft.chord_m / (1.0 + aircraft.taper)
    chords = root * (1.0 - (1.0 - aircraft.taper) * middle)
    areas = chords * np.diff(edges) * aircraft.span_m
    share = 0.5 * (1.0 + 4.0 * aircraft.chord_m / (np.pi * chords) * np.sqrt(1.0 - middle**2))
    share /= np.sum(share * areas) / aircraft.wing_area_m2
    back = 0.5 * aircraft.span_m * middle * np.tan(aircraft.sweep_rad)
    mean_back = float(np.sum(back * share * areas) / aircraft.wing_area_m2)
    wing, tail = slope(aircraft.aspect), slope(aircraft.tail_aspect)
    downwash = 1.75 / (np.pi * aircraft.aspect)
    # Neutral point = centre of gravity + margin: solve the moment's slope for the place of the wing.
    tail_part = (
        tail
        * (1.0 - downwash * wing)
        * aircraft.tail_area_m2
        / aircraft.wing_area_m2
        * aircraft.tail_arm_m
        / aircraft.chord_m
    )
    lift = wing + tail * (1.0 - downwash * wing) * aircraft.tail_area_m2 / aircraft.wing_area_m2
    wing_x = aircraft.chord_m * (aircraft.static_margin * lift - tail_part + aircraft.fuselage_slope) / wing
    weight = aircraft.mass_kg * GRAVITY_M_S2
    return Shape(
        mass=aircraft.mass_kg,
        inertia=aircraft.pitch_inertia_kg_m2,
        density=aircraft.density_kg_m3,
        area=aircraft.wing_area_m2,
        span=aircraft.span_m,
        chord=aircraft.chord_m,
        strip_area=areas,
        strip_x=wing_x + back - mean_back,
        strip_twist=0.05 - aircraft.washout_rad * middle,
        strip_share=share,
        wing_slope=wing,
        section_limit=aircraft.largest_section_lift,
        induced=1.0 / (np.pi * 0.8 * aircraft.aspect),
        drag_0=aircraft.zero_lift_drag,
        tail_x=aircraft.tail_arm_m,
        tail_area=0.92 * aircraft.tail_area_m2,
        tail_slope=tail,
        tail_setting=tail_setting,
        flap=aircraft.flap_effectiveness,
        downwash=downwash,
        fuselage=aircraft.fuselage_slope,
        thrust_0=0.35 * weight,
        thrust_fall=aircraft.thrust_fall,
        speed_0=aircraft.airspeed_m_s,
    )
