"""Model of a hand-flown test input: slewed edges, uneven steps, corrections, an unsteady stick."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np

from .maneuvers import STEPS, Input, elevator_input, stepped
from .scenario import Maneuver

STICK_HZ = 0.3
"""Bandwidth of the stick's random motion, Hz. A hand corrects a few times in ten seconds."""
_TICK_S = 0.02
"""Time step of the stick's random motion, s, with linear interpolation."""
_CORRECTED_S = (-0.7, -0.3)
"""Begin and end of a correction before the first step, s. The elevator is then constant for 0.3 s."""

Steps = tuple[tuple[float, float], ...]


def by_hand(maneuver: Maneuver, amplitude_rad: float, unit_s: float, seed: list[int]) -> Input:
    """Return the input of a manoeuvre as a hand flies it.

    Parameters
    ----------
    maneuver
        Manoeuvre, with the pilot's imperfections.
    amplitude_rad, unit_s
        Amplitude of the input, and duration of one time unit.
    seed
        Random seed of the hand's imperfections.
    """
    if maneuver.input in STEPS:
        steps = _uneven(STEPS[maneuver.input], maneuver.uneven, [*seed, 11])
        stick = stepped(steps, amplitude_rad, unit_s)
        if maneuver.slew_s > 0.0 or maneuver.trim_after:
            stick = _slewed(stick, maneuver.slew_s, maneuver.trim_after * amplitude_rad)
    else:
        stick = elevator_input(maneuver.input, amplitude_rad, unit_s)
    if maneuver.corrected:
        stick = _corrected(stick, maneuver.corrected * amplitude_rad)
    if maneuver.stick > 0.0:
        stick = _restless(stick, maneuver.stick * amplitude_rad, [*seed, 12])
    return stick


def _uneven(steps: Steps, share: float, seed: list[int]) -> Steps:
    """Return the steps with durations and amplitudes that differ by up to ``share``."""
    draw = np.random.default_rng(seed).uniform(1.0 - share, 1.0 + share, (len(steps), 2))
    return tuple(
        (units * float(d), level * float(a)) for (units, level), (d, a) in zip(steps, draw, strict=True)
    )


def _slewed(stick: Input, slew_s: float, trim_after: float = 0.0) -> Input:
    """Return the input with each step stretched into a slope.

    Parameters
    ----------
    stick
        Input made of steps.
    slew_s
        Duration of each slope, s. Each slope begins at the time of its step.
    trim_after
        Deflection at which the stick comes to rest, rad.
    """
    corners = [0.0, *stick.corners_s]
    levels = [
        0.0,
        *(stick.pull(0.5 * (a + b)) for a, b in pairwise(corners)),
        trim_after,
    ]

    def pull(time_s: float) -> float:
        value = 0.0
        for corner, old, new in zip(corners, levels, levels[1:], strict=False):
            # A small tolerance keeps a step on its tick in spite of rounding.
            since = time_s - corner + 1e-9
            done = min(max(since / slew_s, 0.0), 1.0) if slew_s > 0.0 else float(since >= 0.0)
            value += (new - old) * done
        return value

    return Input(stick.duration_s + slew_s, pull, stick.corners_s)


def _corrected(stick: Input, size: float) -> Input:
    """Return the input with a correction of ``size`` (rad) shortly before the first step."""
    begin, end = _CORRECTED_S

    def pull(time_s: float) -> float:
        phase = (time_s - begin) / (end - begin)
        return stick.pull(time_s) + (size * math.sin(math.pi * phase) if 0.0 < phase < 1.0 else 0.0)

    return Input(stick.duration_s, pull, stick.corners_s)


def _restless(stick: Input, size: float, seed: list[int]) -> Input:
    """Return the input with a random motion of the stick by ``size`` (rad, standard deviation)."""
    motion = _wandering(size, seed)
    return Input(stick.duration_s, lambda time_s: stick.pull(time_s) + motion(time_s), stick.corners_s)


def _wandering(size: float, seed: list[int]) -> Callable[[float], float]:
    rng = np.random.default_rng(seed)
    keep = math.exp(-2.0 * math.pi * STICK_HZ * _TICK_S)
    values = [size * float(rng.standard_normal())]

    def at(time_s: float) -> float:
        place = max(0.0, time_s / _TICK_S + 1000.0)
        k = int(place)
        while len(values) < k + 2:
            kick = size * math.sqrt(1.0 - keep * keep) * float(rng.standard_normal())
            values.append(keep * values[-1] + kick)
        return values[k] + (values[k + 1] - values[k]) * (place - k)

    return at
