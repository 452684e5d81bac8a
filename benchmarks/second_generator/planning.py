"""Plan one flight: manoeuvres, quiet flight between them, speeds, heights, power."""

from dataclasses import dataclass

import numpy as np

from .aircraft import Aircraft
from .kernel import Floats
from .maneuvers import KINDS, Maneuver, Plan, shape, size_for, smoothed
from .trim import LinearModel

STEP = 0.002  # s
LEAD_IN = 14.0  # s in which the pilot finds the trim
KIND_SHARES = (0.33, 0.22, 0.12, 0.15, 0.06, 0.12)  # in the order of KINDS
LARGEST_ELEVATOR = np.radians(14.0)


@dataclass(frozen=True)
class Wishes:
    """What a flight must contain: shares by which speed and thrust change, low flight, a hand's ramp [s]."""

    speed_share: float = 0.0
    power_share: float = 0.0
    low: bool = False
    ramp: float = 0.0
    amplitude: float = 1.0
    extra_height: float = 0.0


def _maneuver(
    start: float, aircraft: Aircraft, linear: LinearModel, wishes: Wishes, rng: np.random.Generator
) -> tuple[Maneuver, Floats]:
    kind = str(rng.choice(KINDS, p=KIND_SHARES))
    unit = max(float(rng.uniform(1.6, 2.4)) / linear.natural_frequency, 0.10)
    wave = shape(kind, unit, STEP, rng)
    alpha_peak = np.radians(rng.uniform(1.7, 4.8)) * wishes.amplitude
    amplitude = size_for(linear, wave, STEP, alpha_peak, LARGEST_ELEVATOR)
    direction = float(rng.choice([-1.0, 1.0], p=[0.7, 0.3]))
    settling = float(np.clip(4.0 / (linear.damping_ratio * linear.natural_frequency), 1.5, 5.0))
    end = start + len(wave) * STEP + settling
    speed = aircraft.airspeed_m_s * (1.0 + wishes.speed_share * float(rng.uniform(-1.0, 1.0)))
    if wishes.low:
        height = aircraft.span_m * float(rng.uniform(0.5, 2.5))
    else:
        height = 60.0 + 4.0 * aircraft.span_m + float(rng.uniform(-10.0, 10.0))
    power = wishes.power_share * float(rng.choice([-1.0, 0.0, 1.0], p=[0.4, 0.2, 0.4]))
    maneuver = Maneuver(kind, start, end, unit, amplitude, speed, height + wishes.extra_height, power)
    return maneuver, direction * amplitude * wave


def draw_plan(aircraft: Aircraft, linear: LinearModel, wishes: Wishes, rng: np.random.Generator) -> Plan:
    """Seven to nine manoeuvres; 8 to 15 s of quiet flight between, in which the pilot makes small inputs."""
    planned = []
    start = LEAD_IN
    for _ in range(int(rng.integers(7, 10))):
        maneuver, wave = _maneuver(start, aircraft, linear, wishes, rng)
        planned.append((maneuver, wave))
        start = maneuver.end + float(rng.uniform(8.0, 15.0))
    count = round((planned[-1][0].end + 6.0) / STEP)
    offset: Floats = np.zeros(count)
    hands_off, power = np.zeros(count), np.zeros(count)
    speed = np.full(count, planned[0][0].airspeed)
    height = np.full(count, planned[0][0].height)
    before = 0
    for maneuver, wave in planned:
        first, last = round(maneuver.start / STEP), round(maneuver.end / STEP)
        offset[first : first + len(wave)] = wave
        hands_off[first:last] = 1.0
        speed[before:] = maneuver.airspeed
        height[before:] = maneuver.height
        # Power is changed at some moment of the manoeuvre, not together with the elevator.
        changed = first + round(float(rng.uniform(0.1, 0.6)) * (last - first))
        power[changed:last] = maneuver.power_change
        before = last
        for _ in range(int(rng.integers(0, 3))):
            begin = last + round(float(rng.uniform(0.5, 4.0)) / STEP)
            length = round(2.0 * maneuver.unit / STEP)
            if begin + length < count:
                offset[begin : begin + length] += float(rng.uniform(-0.12, 0.12)) * maneuver.amplitude
    if wishes.ramp > 0.0:
        offset = smoothed(offset, STEP, wishes.ramp)
    return Plan(STEP, tuple(maneuver for maneuver, _ in planned), offset, hands_off, speed, height, power)
