"""Parts of an aircraft other than its flight dynamics: servo, instruments, air, and their effects."""

import math
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from .atmosphere import DrydenTurbulence
from .motion import Motion
from .scenario import Scenario
from .sensors import DerivedAlpha, SensorEffect, low_passes
from .servo import FirstOrderServo, Mechanism, SecondOrderServo, TransportDelay

SERVO_HZ, SERVO_DAMPING = 20.0, 0.8
"""Frequency, Hz, and damping of a servo with a rate limit only."""


class AirMass(Protocol):
    """Moving air, stepped with the simulation."""

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return (gust up, gust head-on) in m/s at ``time_s``."""
        ...


class ForceEffect(Protocol):
    """Forces and moments from outside the equations of motion, stepped with the simulation."""

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return the added (CL, Cm). The linear aircraft uses them as additions to (α̇, q̇)."""
        ...


class PlantEffect(Protocol):
    """A change of the aircraft in flight, applied once per tick."""

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Change fields of ``engine.record``."""
        ...


@dataclass
class Fittings:
    """All parts between the autopilot loop and the flight dynamics, in signal order."""

    mechanisms: list[Mechanism] = field(default_factory=list)
    """Stages between command and surface."""
    air: list[AirMass] = field(default_factory=list)
    forces: list[ForceEffect] = field(default_factory=list)
    plant: list[PlantEffect] = field(default_factory=list)
    sensors: list[SensorEffect] = field(default_factory=list)
    skews: dict[str, float] = field(default_factory=dict)
    """Delay of each channel of :class:`sim.sensors.Reading`, s, by the channel's name."""
    accelerometer_arm_m: float = 0.0
    """Distance of the accelerometer ahead of the centre of gravity, m."""


class Turbulent:
    """Continuous turbulence."""

    def __init__(self, turbulence: DrydenTurbulence) -> None:
        self.turbulence = turbulence

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return the gust speeds after ``dt`` s, m/s."""
        return self.turbulence.step(motion.airspeed, dt)


def complete(scenario: Scenario, fittings: Fittings) -> Fittings:
    """Return the fittings with the scenario's servo, air and alpha sensor first, and the filters last."""
    basics = Fittings(accelerometer_arm_m=scenario.instruments.accelerometer_arm_m)
    servo, air = scenario.servo, scenario.air
    if servo.delay_s > 0.0:
        basics.mechanisms.append(TransportDelay(servo.delay_s))
    if servo.lag_s > 0.0:
        basics.mechanisms.append(FirstOrderServo(servo.lag_s))
    if servo.rate_limit_deg_s > 0.0:
        limit = math.radians(servo.rate_limit_deg_s)
        basics.mechanisms.append(SecondOrderServo(SERVO_HZ, SERVO_DAMPING, limit))
    if air.turbulence_m_s > 0.0:
        generator = np.random.default_rng([scenario.seed, 5])
        basics.air.append(Turbulent(DrydenTurbulence(air.turbulence_m_s, air.length_m, generator)))
    if scenario.alpha.source == "derived":
        basics.sensors.append(DerivedAlpha(scenario.alpha))
    return Fittings(
        fittings.mechanisms + basics.mechanisms,
        basics.air + fittings.air,
        fittings.forces,
        fittings.plant,
        basics.sensors + fittings.sensors + low_passes(scenario.faults.filters),
        fittings.skews,
        basics.accelerometer_arm_m + fittings.accelerometer_arm_m,
    )
