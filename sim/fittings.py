"""What is fitted to an aircraft beside its flight dynamics: servo, instruments, air, and their effects."""

from dataclasses import dataclass, field
from typing import Any, Protocol

from sim.motion import Motion
from sim.sensors import SensorEffect
from sim.servo import Mechanism


class AirMass(Protocol):
    """Moving air, stepped with the simulation."""

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return (gust up, gust head-on) in m/s at ``time_s``."""
        ...


class ForceEffect(Protocol):
    """Forces and moments from outside the equations of motion, stepped with the simulation."""

    def step(self, time_s: float, motion: Motion, dt: float) -> tuple[float, float]:
        """Return added (CL, Cm); the linear aircraft takes them as (α̇, q̇)."""
        ...


class PlantEffect(Protocol):
    """Something about the aircraft itself that changes in flight, asked once a tick."""

    def apply(self, time_s: float, motion: Motion, engine: Any) -> None:
        """Change fields of ``engine.record``."""
        ...


@dataclass
class Fittings:
    """Everything between the loop and the flight dynamics, in the order of the signal's way."""

    mechanisms: list[Mechanism] = field(default_factory=list)
    """Command to surface."""
    air: list[AirMass] = field(default_factory=list)
    forces: list[ForceEffect] = field(default_factory=list)
    plant: list[PlantEffect] = field(default_factory=list)
    sensors: list[SensorEffect] = field(default_factory=list)
    skews: dict[str, float] = field(default_factory=dict)
    """Channel name of :class:`sim.sensors.Reading` to the seconds by which its data are late."""
    accelerometer_arm_m: float = 0.0
    """Of the accelerometer ahead of the centre of gravity."""
