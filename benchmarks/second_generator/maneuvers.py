"""Test inputs, and the plan of a flight: which manoeuvre when, at which speed and height."""

from dataclasses import dataclass

import numpy as np

from .kernel import Floats
from .trim import LinearModel

# Levels of the elevator and how long each lasts, in units of the manoeuvre's time unit.
STEPPED = {
    "3-2-1-1": ((1.0, 3.0), (-1.0, 2.0), (1.0, 1.0), (-1.0, 1.0)),
    "reverse 3-2-1-1": ((1.0, 1.0), (-1.0, 1.0), (1.0, 2.0), (-1.0, 3.0)),
    "modified 3-2-1-1": ((0.8, 3.0), (-1.2, 2.0), (1.1, 1.0), (-1.1, 1.0)),
    "doublet": ((1.0, 2.0), (-1.0, 2.0)),
    "pulse": ((1.0, 2.0),),
}
KINDS = (*STEPPED, "multisine")


@dataclass(frozen=True)
class Maneuver:
    """One test input: when it starts and until when hands stay off [s], and what it is flown at."""

    kind: str
    start: float
    end: float
    unit: float
    amplitude: float
    airspeed: float
    height: float
    power_change: float


@dataclass(frozen=True)
class Plan:
    """A flight on the time grid: elevator asked off trim [rad], hands-off, speed, height, thrust share."""

    step: float
    maneuvers: tuple[Maneuver, ...]
    offset: Floats
    hands_off: Floats
    airspeed: Floats
    height: Floats
    power_change: Floats

    @property
    def time(self) -> Floats:
        """Times of the grid [s]."""
        return self.step * np.arange(len(self.offset))

    @property
    def typical_elevator(self) -> float:
        """Amplitude [rad] of the elevator in the middle one of the manoeuvres."""
        return float(np.median([maneuver.amplitude for maneuver in self.maneuvers]))

    @property
    def largest_elevator(self) -> float:
        """Largest amplitude [rad] of the elevator."""
        return max(maneuver.amplitude for maneuver in self.maneuvers)

    def during_maneuvers(self) -> list[slice]:
        """The grid's samples of each manoeuvre."""
        return [slice(int(m.start / self.step), int(m.end / self.step)) for m in self.maneuvers]


def shape(kind: str, unit: float, step: float, rng: np.random.Generator) -> Floats:
    """A test input of unit size on a time grid."""
    if kind in STEPPED:
        return np.concatenate(
            [np.full(round(length * unit / step), level) for level, length in STEPPED[kind]]
        )
    # Multisine with Schroeder phases, which keep its peaks low; it begins and ends at zero.
    duration = 14.0 * unit
    time = np.arange(round(duration / step)) * step
    harmonics = np.arange(1, 7)
    phases = -np.pi * harmonics * (harmonics - 1) / len(harmonics) + rng.uniform(0.0, 2.0 * np.pi)
    series = np.sum(np.sin(2.0 * np.pi * harmonics[:, None] * time / duration + phases[:, None]), axis=0)
    fade = np.clip(np.minimum(time, duration - time) / (0.5 * unit), 0.0, 1.0)
    wave: Floats = fade * series / np.max(np.abs(series))
    return wave


def size_for(linear: LinearModel, wave: Floats, step: float, alpha_peak: float, limit: float) -> float:
    """Amplitude [rad] of the elevator that moves alpha by `alpha_peak` [rad], at most `limit`."""
    padded = np.concatenate([wave, np.zeros(round(3.0 / linear.natural_frequency / step))])
    alpha, _ = linear.response(padded, step)
    return min(alpha_peak / float(np.max(np.abs(alpha))), limit)


def smoothed(wave: Floats, step: float, ramp: float) -> Floats:
    """The same input by a hand that needs `ramp` seconds from one level to the next."""
    width = max(round(ramp / step), 1)
    return np.convolve(wave, np.full(width, 1.0 / width))[: len(wave)]
