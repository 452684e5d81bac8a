"""Test inputs of the elevator, flown by a pilot or by a program."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

STEPS: Mapping[str, tuple[tuple[float, float], ...]] = {
    # (duration in units, amplitude): areas sum to zero, so that the aircraft returns to trim.
    "3211": ((3.0, 0.8), (2.0, -1.2), (1.0, 1.1), (1.0, -1.1)),
    "rev": ((3.0, -0.8), (2.0, 1.2), (1.0, -1.1), (1.0, 1.1)),
    "doublet": ((1.0, 1.0), (1.0, -1.0)),
    "pulse": ((1.0, 1.0),),
    "121": ((1.0, 1.0), (2.0, -1.0), (1.0, 1.0)),
    "multistep": ((2.0, 0.7), (1.0, -1.0), (1.0, 0.5), (2.0, -0.6), (1.0, 1.0), (1.5, -0.4), (1.5, 0.2)),
    "long": ((16.0, 1.0),),
}
"""Steps of each stepped input, as durations in units and shares of the amplitude. A positive step pulls, so
that the first step of ``3211`` raises the nose."""

MULTISINE_UNITS = 14.0
MULTISINE_HARMONICS = (1, 2, 3, 4, 5, 6, 7)
NONE_UNITS = 7.0

INPUTS = (*STEPS, "multisine", "none")
"""Names of inputs for a scenario; ``none`` leaves the elevator at trim."""


@dataclass(frozen=True)
class Input:
    """An elevator input as a function of time."""

    duration_s: float
    pull: Callable[[float], float]
    """Deflection trailing edge **up** in rad, at a time in seconds after the onset."""
    corners_s: tuple[float, ...] = ()
    """Ends of the steps in s after the onset; empty for an input without steps."""


def elevator_input(name: str, amplitude_rad: float, unit_s: float) -> Input:
    """Return the input called ``name`` (one of :data:`INPUTS`), with a unit of time of ``unit_s``."""
    if name == "none":
        return Input(NONE_UNITS * unit_s, lambda _: 0.0)
    if name == "multisine":
        return _multisine(amplitude_rad, unit_s)
    return stepped(STEPS[name], amplitude_rad, unit_s)


def stepped(steps: tuple[tuple[float, float], ...], amplitude_rad: float, unit_s: float) -> Input:
    """Return the input made of steps (duration in units, share of the amplitude)."""

    def pull(time_s: float) -> float:
        # A small tolerance keeps a step on its tick in spite of rounding.
        left = time_s + 1e-9
        for units, share in steps:
            if 0.0 <= left < units * unit_s:
                return share * amplitude_rad
            left -= units * unit_s
        return 0.0

    ends = [sum(units for units, _ in steps[: k + 1]) * unit_s for k in range(len(steps))]
    return Input(ends[-1], pull, tuple(ends))


def _multisine(amplitude_rad: float, unit_s: float) -> Input:
    """Return harmonics with Schroeder's phases, which give small peaks for much power (Klein &
    Morelli 9.3).
    """
    duration = MULTISINE_UNITS * unit_s
    count = len(MULTISINE_HARMONICS)
    phases = [-math.pi * k * k / count for k in range(count)]

    def pull(time_s: float) -> float:
        if not 0.0 <= time_s < duration:
            return 0.0
        base = 2.0 * math.pi * time_s / duration
        total = sum(math.sin(n * base + phase) for n, phase in zip(MULTISINE_HARMONICS, phases, strict=True))
        # Faded in and out over half a unit, so that the surface does not jump.
        ease = min(1.0, time_s / (0.5 * unit_s), (duration - time_s) / (0.5 * unit_s))
        return amplitude_rad * ease * total / math.sqrt(count)

    return Input(duration, pull)
