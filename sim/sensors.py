"""Instruments: readings of the motion, with noise."""

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from .airframe import GRAVITY_M_S2
from .faults import Filters
from .motion import Motion
from .scenario import AlphaSensor
from .servo import FirstOrderServo, SecondOrderServo


@dataclass(slots=True)
class Reading:
    """Readings of the instruments at one instant, SI units. Effects and noise change the readings in
    place."""

    alpha: float
    q: float
    theta: float
    phi: float
    p: float
    r: float
    a_x: float
    a_y: float
    a_z: float
    airspeed: float
    height: float
    climb: float


NOISY = ("alpha", "q", "theta", "a_x", "a_z", "airspeed", "climb")
"""Channels that carry noise."""


class SensorEffect(Protocol):
    """An error of an instrument, stepped with the simulation."""

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Change ``reading`` in place after ``dt`` seconds of motion."""
        ...


def ideal(motion: Motion, accelerometer_arm_m: float = 0.0) -> Reading:
    """Return readings of perfect instruments. An accelerometer at x ahead of the centre of gravity reads a_z
    − x·q̇ and a_x − x·q²."""
    turn = GRAVITY_M_S2 / motion.airspeed * math.sin(motion.phi) * math.cos(motion.theta)
    return Reading(
        motion.air_alpha,
        motion.q,
        motion.theta,
        motion.phi,
        motion.p,
        turn if motion.r is None else motion.r,
        motion.a_x - accelerometer_arm_m * motion.q**2,
        motion.a_y,
        motion.a_z - accelerometer_arm_m * motion.q_dot,
        motion.pitot_airspeed,
        motion.height,
        motion.climb,
    )


class DerivedAlpha:
    """ArduPilot's angle of attack from inertial speed. It is late, has an offset, and has its own rate of new
    values.
    """

    def __init__(self, sensor: AlphaSensor) -> None:
        self._sensor = sensor
        self._filter = FirstOrderServo(max(sensor.lag_s, 1e-6))
        self._awake = False
        self._shown = 0.0
        self._next_s = 0.0
        self._time_s = 0.0

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the reading of the vane. The α of the motion contains no gusts."""
        if not self._awake or dt == 0.0:
            self._filter.reset(motion.alpha)
            self._awake = True
            lagged = motion.alpha
        else:
            lagged = self._filter.step(motion.alpha, dt)
        self._time_s += dt
        if self._time_s >= self._next_s - 1e-9:
            self._shown = lagged + math.radians(self._sensor.bias_deg)
            self._next_s += 1.0 / self._sensor.renewed_hz
        reading.alpha = self._shown


class LowPass:
    """Second-order Butterworth filter of an instrument, with a delay of √2/(2πf) at low frequency."""

    def __init__(self, channels: tuple[str, ...], cutoff_hz: float) -> None:
        self._filters = {name: SecondOrderServo(cutoff_hz, math.sqrt(0.5)) for name in channels}

    def apply(self, motion: Motion, reading: Reading, dt: float) -> None:
        """Replace the readings by the filtered channels."""
        for name, each in self._filters.items():
            if dt == 0.0:
                each.reset(getattr(reading, name))
            else:
                setattr(reading, name, each.step(getattr(reading, name), dt))


def low_passes(filters: Filters) -> list[SensorEffect]:
    """Return the filters that have a cut-off."""
    pairs = ((("p", "q", "r"), filters.gyro_hz), (("a_x", "a_y", "a_z"), filters.accelerometer_hz))
    return [LowPass(channels, cutoff_hz) for channels, cutoff_hz in pairs if cutoff_hz > 0.0]


class ChannelNoise:
    """Gaussian noise on each channel, white or AR(1), each channel with its own generator."""

    def __init__(self, sigma: dict[str, float], colour: float, seed: int) -> None:
        self._sigma = sigma
        self._colour = colour
        self._generators = {
            name: np.random.default_rng([seed, number]) for number, name in enumerate(NOISY, start=101)
        }
        self._stock: dict[str, list[float]] = {name: [] for name in NOISY}
        self._last = dict.fromkeys(NOISY, 0.0)
        self._fresh = math.sqrt(1.0 - colour**2)

    def add(self, reading: Reading) -> None:
        """Add one noise sample to every channel."""
        for name, sigma in self._sigma.items():
            stock = self._stock[name]
            if not stock:
                stock = self._stock[name] = self._generators[name].standard_normal(1024).tolist()
            drawn = self._colour * self._last[name] + self._fresh * stock.pop()
            self._last[name] = drawn
            setattr(reading, name, getattr(reading, name) + sigma * drawn)
