"""One flight: a pilot between manoeuvres, test inputs within, integrated by Runge-Kutta at 200 Hz."""

from dataclasses import dataclass
from typing import NamedTuple

import numba
import numpy as np

from .fleet import GRAVITY_M_S2, Floats, Shape
from .motion import Around, Faults, slopes
from .servo import Servo, moved

STEP_S = 0.005
TAKE_OVER_S = 3.0
LARGEST_SWING_RAD = 0.35
"""Angle of attack between its least and its largest value; beyond, the aircraft is out of control."""
RECORDED = (
    "alpha",
    "q",
    "theta",
    "a_x",
    "a_z",
    "airspeed",
    "climb",
    "height",
    "command",
    "throttle",
    "q_dot",
    "surface",
)

Channels = dict[str, Floats]


class Gains(NamedTuple):
    """A pilot's hand between manoeuvres, and the damper that stays on within."""

    pitch: float
    rate: float
    height: float
    throttle: float
    damper: float
    delay_s: float = 0.0
    """Time between the motion and the hand's response, s."""
    take_over_s: float = TAKE_OVER_S
    """Time over which the hand takes over after a test, s."""


@dataclass(frozen=True)
class Inputs:
    """What the flight is given at every step of 5 ms; ``hands_off`` is one within a manoeuvre."""

    stick: Floats
    hands_off: Floats
    speed: Floats
    height: Floats
    alpha: Floats
    delta: Floats
    throttle: Floats
    throttle_step: Floats
    remnant: Floats
    """Motion of the hand without any cause in the aircraft's motion, rad."""
    around: tuple[Floats, ...]
    """One series for each member of ``Around``."""


@numba.njit(cache=True)
def _at(series, k, spoilers):  # type: ignore[no-untyped-def]
    a = series[:, k]
    return Around(a[0], a[1], a[2], a[3], a[4], a[5], a[6], spoilers)


@numba.njit(cache=True)
def _fly(y, plan, series, shape, faults, servo, gains, latch):  # type: ignore[no-untyped-def]
    steps = plan.shape[1]
    out = np.empty((12, steps))
    commands = np.empty(steps)
    held_delta, held_throttle = plan[5, 0], plan[6, 0]
    linkage = np.array([held_delta, held_delta, held_delta, held_delta, 0.0])
    floating, before, taken = 0.0, held_delta, 1.0
    late = round(gains.delay_s / STEP_S)
    for k in range(steps):
        stick, hands_off, speed, height, alpha_0, delta_0, throttle_0, power, remnant = plan[:, k]
        here = _at(series, k, floating)
        v = np.sqrt((y[0] + here.headwind) ** 2 + (y[1] + here.updraft * np.cos(y[3])) ** 2)
        climb = y[0] * np.sin(y[3]) - y[1] * np.cos(y[3])
        if hands_off < 0.5:
            path = min(max(gains.height * (height - y[4]) - 1.5 * climb / speed, -0.06), 0.06)
            theta, q = y[3], y[2]
            if late > 0:
                theta, q = out[2, max(k - late, 0)], out[1, max(k - late, 0)]
            wanted = delta_0 + gains.pitch * (theta - alpha_0 - path) + gains.rate * q
            # Taken over softly after a test.
            taken = min(taken + STEP_S / gains.take_over_s, 1.0)
            delta = remnant + held_delta + taken * (wanted - held_delta)
            throttle = min(max(throttle_0 + gains.throttle * (speed - v), 0.0), 2.0)
            # The hand remembers where it has been in the last second.
            held_delta += (delta - remnant - held_delta) * STEP_S / 0.8
            held_throttle += (throttle - held_throttle) * STEP_S / 0.8
        else:
            taken = 0.0
            delta, throttle = held_delta + stick + gains.damper * y[2], held_throttle + power
        commands[k] = min(max(delta, -latch[2]), latch[2])
        surface = moved(linkage, commands, k, STEP_S, servo)
        one, a_x, a_z = slopes(y, surface, throttle, here, shape, faults)
        air = np.arctan2(y[1] + here.updraft * np.cos(y[3]), y[0] + here.headwind)
        load = -a_z / GRAVITY_M_S2
        if load > latch[0]:
            floating = 1.0
        elif load < latch[1]:
            floating = 0.0
        out[0, k], out[1, k], out[2, k], out[3, k], out[4, k], out[5, k] = air, y[2], y[3], a_x, a_z, v
        out[6, k], out[7, k], out[8, k], out[9, k] = climb, y[4], commands[k], throttle
        out[10, k], out[11, k] = one[2], surface
        # The surface goes on as it went in the last step: held, it would be half a step late.
        step, before = surface - before, surface
        middle, end = surface + 0.5 * step, surface + step
        two, _, _ = slopes(y + 0.5 * STEP_S * one, middle, throttle, here, shape, faults)
        three, _, _ = slopes(y + 0.5 * STEP_S * two, middle, throttle, here, shape, faults)
        four, _, _ = slopes(y + STEP_S * three, end, throttle, here, shape, faults)
        y = y + STEP_S / 6.0 * (one + 2.0 * two + 2.0 * three + four)
    return out


def fly(
    start: Floats,
    inputs: Inputs,
    shape: Shape,
    faults: Faults,
    servo: Servo,
    gains: Gains,
    spoilers: tuple[float, float],
    reach_rad: float,
) -> tuple[Floats, Channels]:
    """Time [s] and the true channels; ``spoilers``: load factors at which they float and close again."""
    plan = np.array(
        [
            inputs.stick,
            inputs.hands_off,
            inputs.speed,
            inputs.height,
            inputs.alpha,
            inputs.delta,
            inputs.throttle,
            inputs.throttle_step,
            inputs.remnant,
        ]
    )
    latch = np.array([spoilers[0], spoilers[1], reach_rad])
    rows = _fly(start, plan, np.array(inputs.around), shape, faults, servo, gains, latch)
    if not np.all(np.isfinite(rows)) or np.ptp(rows[0]) > LARGEST_SWING_RAD:
        raise ArithmeticError("the aircraft left its regime of flight")
    return STEP_S * np.arange(plan.shape[1]), dict(zip(RECORDED, rows, strict=True))
