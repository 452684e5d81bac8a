"""Outputs of a PX4 log that follow the pitch command, where no parameter names them.

PX4 before 1.13 mixes its outputs by files that no log holds. The outputs are linear in the commands, so that
least squares of each output on the commands gives the mixer.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.flight.vehicle.px4_wiring import OUTPUTS
from advisor.mavlink.px4.px4_topics import Topic, Topics, published_us, vector

_FOLLOWS = 0.5
"""Least share of an output's movement, without the other commands' part, that the pitch command must explain.
At 10 Hz two topics catch different moments of each step and keep about 0.8."""
_SMALLER = 0.3
"""Least effect of pitch on an output, as a share of the largest effect on any output. A smaller effect is a
mixer's trim, such as flaps that compensate."""
_LEAST_SAMPLES = 20


@dataclass(frozen=True, slots=True)
class Command:
    """Commands of the attitude controller, -1 to 1."""

    name: str
    """Name of the topic."""
    topic: Topic
    axes: Mapping[str, FloatArray]
    """Roll, pitch, yaw and, where the topic has one, throttle; shape (n,). Positive pitch lifts the nose."""


def pitch_commands(topics: Topics) -> list[Command]:
    """Return the topics with the commands, the preferred first. For a VTOL aircraft, the topic of the wing
    comes last."""
    found = []
    for topic in topics.get("actuator_controls_0", []):
        axes = dict(zip(("roll", "pitch", "yaw", "throttle"), vector(topic, "control", 4), strict=True))
        found.append(Command("actuator_controls_0", topic, axes))
    for topic in topics.get("vehicle_torque_setpoint", []):
        axes = dict(zip(("roll", "pitch", "yaw"), vector(topic, "xyz", 3), strict=True))
        found.append(Command("vehicle_torque_setpoint", topic, axes))
    return found


def followers(outputs: Topic, command: Command) -> dict[int, float]:
    """Return the outputs that follow the pitch command: number from 1 to 1.0, or to -1.0 for the opposite."""
    at, known = published_us(outputs), published_us(command.topic)
    told = {name: np.interp(at, known, values) for name, values in command.axes.items()}
    inside = (at >= known[0]) & (at <= known[-1]) & np.all(np.isfinite([*told.values()]), axis=0)
    axes = {name: values[inside] for name, values in told.items()}
    pitch = axes.pop("pitch")
    if len(pitch) < _LEAST_SAMPLES or not np.ptp(pitch) > 0.0:
        return {}
    others = np.column_stack([np.ones(len(pitch)), *axes.values()])
    freed = _without(others, pitch)
    effects: dict[int, float] = {}
    for k in OUTPUTS:
        moved = _without(others, outputs[f"output[{k - 1}]"][inside].astype(np.float64))
        size = float(moved @ moved) * float(freed @ freed)
        if np.isfinite(size) and size > 0.0 and float(moved @ freed) ** 2 >= _FOLLOWS * size:
            effects[k] = float(moved @ freed) / float(freed @ freed)
    largest = max(map(abs, effects.values()), default=0.0)
    return {k: float(np.sign(effect)) for k, effect in effects.items() if abs(effect) >= _SMALLER * largest}


def _without(columns: FloatArray, values: FloatArray) -> FloatArray:
    """Return the residual of the values after least squares on the columns."""
    if not np.all(np.isfinite(values)):
        return np.full(len(values), np.nan)
    return np.asarray(values - columns @ np.linalg.lstsq(columns, values, rcond=None)[0])
