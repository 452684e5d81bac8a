"""Laws of roll and yaw that no effect describes: surfaces that bend, stick or ring, a sensor that clips,
moments that are curved."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from sim import hangar
from sim.effects.side import SideKit
from sim.flight import Flight
from sim.lateral import FULL_RAD, UAV, LateralAircraft, flown_laterally
from sim.motion import Motion
from sim.scenario import Scenario
from sim.sensors import Reading


class Bends:
    """A linkage whose ratio grows with the deflection."""

    def __init__(self, at_full: float) -> None:
        self.at_full = at_full

    def reset(self, value: float) -> None:
        """Nothing to stand still."""

    def step(self, value: float, dt: float) -> float:
        """Return the deflection, rad."""
        return value * (1.0 + self.at_full * abs(value) / FULL_RAD)


class Sticks:
    """A surface that moves only where the command is far enough away, and then jumps to the command."""

    def __init__(self, breakaway_rad: float) -> None:
        self.breakaway_rad, self._at = breakaway_rad, 0.0

    def reset(self, value: float) -> None:
        """Stand still at ``value``."""
        self._at = value

    def step(self, value: float, dt: float) -> float:
        """Return the deflection, rad."""
        if abs(value - self._at) > self.breakaway_rad:
            self._at = value
        return self._at


class Rings:
    """A servo of second order that overshoots."""

    def __init__(self, omega_rad_s: float, damping: float) -> None:
        self.omega, self.damping, self._x, self._v = omega_rad_s, damping, 0.0, 0.0

    def reset(self, value: float) -> None:
        """Stand still at ``value``."""
        self._x, self._v = value, 0.0

    def step(self, value: float, dt: float) -> float:
        """Return the deflection, rad."""
        self._v += dt * self.omega * (self.omega * (value - self._x) - 2.0 * self.damping * self._v)
        self._x += dt * self._v
        return self._x


class Clips:
    """A sensor that reads no more than its range."""

    def __init__(self, channel: str, most: float) -> None:
        self.channel, self.most = channel, most

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Limit the reading."""
        value = getattr(reading, self.channel)
        setattr(reading, self.channel, min(max(value, -self.most), self.most))


class Curved(LateralAircraft):
    """An aircraft with a moment that grows with the square of one state."""

    letter, state, per_square = "L", 1, 0.0

    def _per_speed(self, letter: str, x: NDArray[np.float64], u: NDArray[np.float64]) -> float:
        linear = super()._per_speed(letter, x, u)
        return linear + (
            self.per_square * x[self.state] * abs(x[self.state]) if letter == self.letter else 0.0
        )


Fit = Callable[[SideKit, float], None]
MECHANISMS: Mapping[str, tuple[Fit, tuple[float, float]]] = {
    "aileron bends": (lambda kit, size: kit.mechanisms["aileron"].append(Bends(size)), (0.3, 0.8)),
    "rudder sticks": (lambda kit, size: kit.mechanisms["rudder"].append(Sticks(size)), (0.01, 0.03)),
    "aileron rings": (lambda kit, size: kit.mechanisms["aileron"].append(Rings(size, 0.2)), (12.0, 25.0)),
    "roll rate clips": (lambda kit, size: kit.fittings.sensors.append(Clips("p", size)), (0.25, 0.5)),
}
"""Law to what fits it to a kit, and the least and greatest size, SI."""
CURVES: Mapping[str, tuple[str, int, tuple[float, float]]] = {
    "curved damping in roll": ("L", 1, (-12.0, -5.0)),
    "curved damping in yaw": ("N", 2, (-8.0, -3.0)),
    "curved dihedral": ("L", 0, (60.0, 150.0)),
}
"""Law to the moment, the state, and the least and greatest size, rad and s."""
LAWS = (*MECHANISMS, *CURVES)


def flight_with(scenario: Scenario, law: str, rng: np.random.Generator) -> tuple[Flight, float]:
    """Return the lateral plan flown with a law of a drawn size, and the size."""
    low, high = MECHANISMS[law][1] if law in MECHANISMS else CURVES[law][2]
    size = float(rng.uniform(low, high))
    scenario, kit = replace(scenario, effects={}), SideKit(scenario.seed)
    if law in MECHANISMS:
        MECHANISMS[law][0](kit, size)
    known = hangar.build(scenario)
    engine = Curved(known.truth, known.motion().airspeed, scenario.height_m, UAV, kit)
    if law in CURVES:
        engine.letter, engine.state, engine.per_square = *CURVES[law][:2], size
    return flown_laterally(scenario, engine, kit), size
