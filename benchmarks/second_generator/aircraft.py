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

FLEET = (
    Aircraft(
        name="foam uav",
        mass_kg=2.4,
        pitch_inertia_kg_m2=0.14,
        wing_area_m2=0.45,
        chord_m=0.22,
        airspeed_m_s=16.0,
        elevation_m=120.0,
        arm_scale_m=0.35,
        cl_0=0.16,
        cl_alpha=4.8,
        cl_q=4.0,
        cl_delta_e=0.32,
        cd_0=0.035,
        induced_drag=0.075,
        cm_0=0.035,
        cm_alpha=-0.60,
        cm_q=-10.0,
        cm_delta_e=-0.90,
    ),
    Aircraft(
        name="survey uav",
        mass_kg=20.0,
        pitch_inertia_kg_m2=3.2,
        wing_area_m2=1.2,
        chord_m=0.42,
        airspeed_m_s=27.0,
        elevation_m=200.0,
        arm_scale_m=0.8,
        cl_0=0.20,
        cl_alpha=5.0,
        cl_q=5.0,
        cl_delta_e=0.38,
        cd_0=0.032,
        induced_drag=0.060,
        cm_0=0.030,
        cm_alpha=-0.70,
        cm_q=-13.0,
        cm_delta_e=-1.0,
    ),
    Aircraft(
        # Nearly neutral static stability and a large tail: the short period is overdamped.
        name="overdamped uav",
        mass_kg=90.0,
        pitch_inertia_kg_m2=38.0,
        wing_area_m2=2.9,
        chord_m=0.55,
        airspeed_m_s=38.0,
        elevation_m=300.0,
        arm_scale_m=1.2,
        cl_0=0.22,
        cl_alpha=5.2,
        cl_q=6.0,
        cl_delta_e=0.40,
        cd_0=0.028,
        induced_drag=0.050,
        cm_0=0.010,
        cm_alpha=-0.10,
        cm_q=-34.0,
        cm_delta_e=-1.0,
    ),
    Aircraft(
        # Thin air and a short tail: the short period is weakly damped.
        name="high drone",
        mass_kg=300.0,
        pitch_inertia_kg_m2=300.0,
        wing_area_m2=9.0,
        chord_m=0.70,
        airspeed_m_s=60.0,
        elevation_m=9000.0,
        arm_scale_m=1.8,
        cl_0=0.18,
        cl_alpha=5.4,
        cl_q=3.0,
        cl_delta_e=0.30,
        cd_0=0.022,
        induced_drag=0.035,
        cm_0=0.060,
        cm_alpha=-1.8,
        cm_q=-8.0,
        cm_delta_e=-1.1,
    ),
    Aircraft(
        name="motor glider",
        mass_kg=380.0,
        pitch_inertia_kg_m2=620.0,
        wing_area_m2=11.0,
        chord_m=0.85,
        airspeed_m_s=32.0,
        elevation_m=600.0,
        arm_scale_m=2.0,
        cl_0=0.30,
        cl_alpha=5.6,
        cl_q=6.0,
        cl_delta_e=0.40,
        cd_0=0.020,
        induced_drag=0.025,
        cm_0=0.040,
        cm_alpha=-0.75,
        cm_q=-16.0,
        cm_delta_e=-1.1,
    ),
    Aircraft(
        name="light aircraft",
        mass_kg=1050.0,
        pitch_inertia_kg_m2=1825.0,
        wing_area_m2=16.2,
        chord_m=1.49,
        airspeed_m_s=52.0,
        elevation_m=1500.0,
        arm_scale_m=2.5,
        cl_0=0.28,
        cl_alpha=4.9,
        cl_q=4.5,
        cl_delta_e=0.40,
        cd_0=0.030,
        induced_drag=0.055,
        cm_0=0.020,
        cm_alpha=-0.75,
        cm_q=-14.0,
        cm_delta_e=-1.15,
    ),
    Aircraft(
        name="turboprop",
        mass_kg=4600.0,
        pitch_inertia_kg_m2=24000.0,
        wing_area_m2=26.0,
        chord_m=1.75,
        airspeed_m_s=95.0,
        elevation_m=3000.0,
        arm_scale_m=5.0,
        cl_0=0.25,
        cl_alpha=5.4,
        cl_q=7.0,
        cl_delta_e=0.45,
        cd_0=0.026,
        induced_drag=0.040,
        cm_0=0.040,
        cm_alpha=-1.0,
        cm_q=-20.0,
        cm_delta_e=-1.5,
    ),
)


def scattered(aircraft: Aircraft, rng: np.random.Generator, share: float = 0.2) -> Aircraft:
    """The same aircraft with each coefficient off by at most `share`, so that no two cases are alike."""
    factors = rng.uniform(1.0 - share, 1.0 + share, len(COEFFICIENTS))
    changed = {
        name: getattr(aircraft, name) * float(f) for name, f in zip(COEFFICIENTS, factors, strict=True)
    }
    return replace(aircraft, **changed)
