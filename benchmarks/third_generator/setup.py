"""One flight with everything that may be wrong with it; effects take a set-up and give another."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.random import Generator

from .fleet import Floats
from .flight import Channels
from .instruments import Instruments, Sensing, measured
from .motion import Faults
from .plan import Plan, Wishes, flown
from .servo import Servo

NO_FAULTS = Faults()
NO_WISHES = Wishes()


@dataclass(frozen=True)
class Setup:
    """What is flown and how it is seen."""

    plan: Plan
    kit: Instruments
    servo: Servo
    around: dict[str, Floats]
    faults: Faults = NO_FAULTS
    spoilers: tuple[float, float] = (1e9, -1e9)
    sensing: tuple[Sensing, ...] = ()

    def fault(self, **values: float) -> "Setup":
        """With other equations of motion."""
        return replace(self, faults=self.faults._replace(**values))

    def steering(self, **values: float) -> "Setup":
        """With another servo."""
        return replace(self, servo=self.servo._replace(**values))

    def surrounded(self, name: str, series: Floats) -> "Setup":
        """With a series added to what surrounds the aircraft."""
        return replace(self, around={**self.around, name: self.around[name] + series})

    def seen(self, *changes: Sensing) -> "Setup":
        """With other instruments."""
        return replace(self, sensing=(*self.sensing, *changes))

    def flight(self) -> Channels:
        """What the instruments show of the flight, without noise."""
        true = flown(self.plan, self.faults, self.servo, self.around, self.spoilers)
        return measured(true, self.kit, self.sensing)


Applied = tuple[Setup, dict[str, float]]


@dataclass(frozen=True)
class Effect:
    """An effect: its block, the range of its size, and what it does to a set-up."""

    block: str
    low: float
    high: float
    most: float
    """Largest size to which an invisible effect grows."""
    apply: Callable[[Setup, float, Generator], Applied]
    dynamic: bool = True
    needs_boom: bool = False
    in_turbulence: bool = False
    wishes: Wishes = NO_WISHES


def sign(rng: Generator) -> float:
    """One or minus one."""
    return float(rng.choice([-1.0, 1.0]))


def moments(setup: Setup, rng: Generator, count: int) -> Floats:
    """Starts of the tests of ``count`` manoeuvres [s], at most of all."""
    starts = np.array([m.input_s for m in setup.plan.maneuvers])
    return np.asarray(rng.choice(starts, size=min(count, starts.size), replace=False))


def change_at(setup: Setup, rng: Generator) -> float:
    """A time between two manoeuvres, in the middle half of the flight [s]."""
    tests = setup.plan.maneuvers
    k = int(rng.integers(len(tests) // 3, 2 * len(tests) // 3 + 1))
    return 0.5 * (tests[k - 1].end_s + tests[k].start_s)


def only(channel: str, change: Callable[[Floats, Floats, Channels], Floats]) -> Sensing:
    """Change one channel: time, its series and all channels in, series out."""

    def sensing(time: Floats, channels: Channels) -> Channels:
        return {**channels, channel: change(time, channels[channel], channels)}

    return sensing


def both_gyros(change: Callable[[Floats], Floats]) -> tuple[Sensing, Sensing]:
    """One change for the attitude's rate and the raw gyro, which are one sensor."""
    return only("q", lambda t, x, c: change(x)), only("imu_q", lambda t, x, c: change(x))


def named_parameters(**values: Any) -> dict[str, float]:
    """Parameters as plain numbers."""
    return {name: float(value) for name, value in values.items()}
