"""Inputs that a pilot can fly: order of steps, time unit, amplitude, direction, and spoken form."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from advisor.process.arrays import FloatArray

if TYPE_CHECKING:
    from advisor.oem.rows import Signal

ORDERS: Mapping[str, tuple[int, ...]] = {
    "3-2-1-1": (3, 2, 1, 1),
    "3-1-1-1-1": (3, 1, 1, 1, 1),
    "1-2-2-1-1": (1, 2, 2, 1, 1),
    "1-2-2-1": (1, 2, 2, 1),
    "2-1-1": (2, 1, 1),
    "doublet": (1, 1),
}
"""Durations of the steps of each input, in time units, by the input's name. The steps alternate between both
sides of trim.

No order is longer than the textbook 3-2-1-1. A long first step shows the stiffness, and a run of equal steps
excites the short period. A half step at first (1-2-2-...) moves the aircraft evenly about trim, and allows
more stick within a limit of α.
"""

SHORTEST_UNIT_S = 0.2
"""Shortest time unit of an input, s. A hand cannot fly shorter steps, and a servo does not follow them."""
EDGE_S = 0.02
"""Time that the elevator takes from one step to the next, s."""


@dataclass(frozen=True, slots=True)
class StepInput:
    """One test input with alternating steps about trim."""

    order: str
    """Name of the step order, a key of ``ORDERS``."""
    unit_s: float
    amplitude_rad: float
    """Distance of every step from trim."""
    nose_up_first: bool
    """Direction of the first step: nose up, or to the right. The opposite direction is called reverse."""
    control: str = "elevator"
    """Control that moves: ``elevator``, ``aileron`` or ``rudder``."""

    @property
    def duration_s(self) -> float:
        """Time from the first step to the return to trim, s."""
        return self.unit_s * sum(ORDERS[self.order])

    @property
    def steps(self) -> tuple[tuple[bool, float], ...]:
        """Steps in order: whether the step is nose up or to the right, and its duration, s."""
        return tuple(
            (self.nose_up_first == (k % 2 == 0), units * self.unit_s)
            for k, units in enumerate(ORDERS[self.order])
        )

    def elevator(self, trim_rad: float, lead_s: float, length_s: float) -> "Signal":
        """Return the elevator command in rad, trailing edge down positive, with its first step at
        ``lead_s``."""
        from advisor.oem.rows import Signal  # with the kernels, which the screens do without

        side = -1.0 if self.nose_up_first else 1.0
        corners, levels = [0.0], [0.0]
        onset, level = lead_s, 0.0
        for units in (*ORDERS[self.order], 0):
            corners += [onset, onset + EDGE_S]
            levels += [level, side if units else 0.0]
            level, side, onset = levels[-1], -side, onset + units * self.unit_s
        t = np.array([*corners, max(length_s, corners[-1] + EDGE_S)])
        return Signal(t, trim_rad + self.amplitude_rad * np.array([*levels, 0.0]))

    def spoken(self, travel_rad: float) -> str:
        """Return the input as spoken to a pilot: ``reverse 3-2-1-1, 0.4 s steps, 60 % stick``."""
        words = ["" if self.nose_up_first else "reverse", "" if self.control == "elevator" else self.control]
        moved = "pedal" if self.control == "rudder" else "stick"
        called = " ".join(filter(None, (*words, self.order)))
        return f"{called}, {self.unit_s:.1f} s steps, {self.stick_percent(travel_rad)} % {moved}"

    def rounded(self, travel_rad: float) -> "StepInput":
        """Return the input with an amplitude in spoken steps, rounded down unless that gives zero."""
        return replace(self, amplitude_rad=0.01 * self.stick_percent(travel_rad) * travel_rad)

    def stick_percent(self, travel_rad: float) -> int:
        """Return the amplitude in percent of the elevator's travel, in steps of five above 20 %."""
        percent = 100.0 * self.amplitude_rad / travel_rad + 1e-9
        return 5 * int(percent / 5.0) if percent > 20.0 else max(1, int(percent))


def units_to_try(natural_frequency: float) -> FloatArray:
    """Return units of time from 0.5/ω to 3.2/ω, rounded to tenths of a second as a pilot can count them."""
    wanted = np.array([0.5, 0.8, 1.2, 1.6, 2.0, 2.6, 3.2]) / natural_frequency
    return np.unique(np.maximum(np.round(wanted, 1), SHORTEST_UNIT_S))
