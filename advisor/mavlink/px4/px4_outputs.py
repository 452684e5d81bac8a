"""Servo outputs of a PX4 log: SERVO_OUTPUT_RAW from outputs, servos or the pitch command.

PX4 publishes the outputs of each driver as an instance of ``actuator_outputs``, in the order in which the
drivers started. Only the movements show which instance belongs to PWM_MAIN, and which to PWM_AUX.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from advisor.flight.signals.messages import FloatArray, IntArray
from advisor.flight.vehicle.px4_wiring import (
    FOLLOWS_PITCH,
    OUTPUTS,
    STANDS_FOR_ELEVATOR,
    allocation,
    banks,
    px4_wiring,
    servo_outputs,
)
from advisor.mavlink.px4.px4_pitch import Command, followers, pitch_commands
from advisor.mavlink.px4.px4_topics import (
    TimedMessages,
    Topic,
    Topics,
    best,
    first,
    published_us,
    rate_hz,
    vector,
)


@dataclass(frozen=True, slots=True)
class Outputs:
    """The outputs, and findings about them."""

    messages: Sequence[TimedMessages]
    found: Mapping[str, float]
    """Findings in the form of parameters."""
    said: Sequence[str] = ()
    """Sentences for the user on the source of the outputs."""


def outputs(topics: Topics, parameters: Mapping[str, float]) -> Outputs:
    """Return the outputs by the parameters that describe them, else by their agreement with the pitch
    command."""
    moving = _moving(topics.get("actuator_outputs", []))
    if any(role.surface for role in px4_wiring(parameters).roles.values()):
        return _of_surfaces(topics, moving, parameters)
    commands = pitch_commands(topics)
    for command in commands:
        for port, topic in enumerate(moving):
            senses = followers(topic, command)
            if senses and best((topic, command.topic)) is topic:
                numbered = {f"{FOLLOWS_PITCH}{16 * port + k}": sense for k, sense in senses.items()}
                return Outputs([_of_instance(n, one) for n, one in enumerate(moving)], numbered)
    if commands and _varies(commands[0].axes["pitch"]):
        return Outputs([_of_command(commands[0])], {f"{FOLLOWS_PITCH}1": STANDS_FOR_ELEVATOR})
    return Outputs([_of_instance(port, topic) for port, topic in enumerate(moving)], {})


def _of_surfaces(topics: Topics, moving: Sequence[Topic], parameters: Mapping[str, float]) -> Outputs:
    """Return the outputs from the fastest of outputs, servo commands and torque set point.

    By default PX4 logs outputs and servos every 100 ms, and the torque set point every 20 ms. The control
    allocation of the surfaces gives the servo commands from the torque.
    """
    servos = first(topics, "actuator_servos")
    # For a VTOL aircraft the last instance is the wing's.
    torque = topics["vehicle_torque_setpoint"][-1] if "vehicle_torque_setpoint" in topics else None
    assigned = _assigned(moving, parameters)
    chosen = best([*assigned.values(), servos, torque])
    if chosen is not None and chosen is torque:
        slow = best([*assigned.values(), servos])
        said = [] if slow is None else [_computed(torque, slow)]
        return Outputs(_of_servos(_allocated(torque, parameters), parameters), {}, said)
    if chosen is not None and chosen is servos:
        return Outputs(_of_servos(servos, parameters), {})
    return Outputs([_of_instance(port, topic) for port, topic in assigned.items()], {})


def _computed(torque: Topic, slow: Topic) -> str:
    return (
        f"The surfaces' commands are computed from vehicle_torque_setpoint at {rate_hz(torque):.0f} Hz: the "
        f"servo outputs are logged at {rate_hz(slow):.0f} Hz"
    )


def _allocated(torque: Topic, parameters: Mapping[str, float]) -> Topic:
    """Return the servo commands that the control allocation makes from a torque set point."""
    axes = vector(torque, "xyz", 3)
    commands = {
        f"control[{n}]": np.clip(np.asarray(gains) @ axes, -1.0, 1.0)
        for n, gains in allocation(parameters).items()
    }
    return {"timestamp": torque["timestamp"], **commands}


def _moving(instances: Sequence[Topic]) -> list[Topic]:
    """Return the instances in which any output moves; all where none does."""
    moving = [topic for topic in instances if any(_moves(topic, k) for k in OUTPUTS)]
    return moving or list(instances)


def _moves(topic: Topic, k: int) -> bool:
    return _varies(topic[f"output[{k - 1}]"])


def _varies(values: FloatArray) -> bool:
    good = values[np.isfinite(values)]
    return len(good) > 0 and float(np.ptp(good)) > 0.0


def _assigned(instances: Sequence[Topic], parameters: Mapping[str, float]) -> dict[int, Topic]:
    """Return instances by the number of the group, from 0, whose functions agree best with the moving
    outputs."""
    agreements = []
    for bank, group in enumerate(banks(parameters) or ["PWM_MAIN"]):
        used = {k for k in OUTPUTS if parameters.get(f"{group}_FUNC{k}")}
        for n, topic in enumerate(instances):
            agreements.append((sum(-1 if k in used else 1 for k in OUTPUTS if _moves(topic, k)), bank, n))
    found: dict[int, int] = {}
    for _, bank, n in sorted(agreements):
        if bank not in found and n not in found.values():
            found[bank] = n
    return {bank: instances[n] for bank, n in found.items()}


def _of_instance(port: int, topic: Topic) -> TimedMessages:
    return _pulses(port, published_us(topic), {k: topic[f"output[{k - 1}]"] for k in OUTPUTS})


def _of_servos(servos: Topic, parameters: Mapping[str, float]) -> list[TimedMessages]:
    """Return pulses of the outputs that carry servos, from normalised servo commands."""
    ports: dict[int, dict[int, FloatArray]] = {}
    for output in servo_outputs(parameters):
        field = f"control[{output.servo}]"
        if field in servos:
            scale = output.scale
            command = servos[field].astype(np.float64) * (-1.0 if scale.reversed else 1.0)
            pulses = np.interp(command, [-1.0, 0.0, 1.0], [scale.low_us, scale.trim_us, scale.high_us])
            port, k = divmod(output.number - 1, 16)
            ports.setdefault(port, {})[k + 1] = np.where(np.isfinite(command), pulses, np.nan)
    return [_pulses(port, published_us(servos), pulses) for port, pulses in ports.items()]


def _of_command(command: Command) -> TimedMessages:
    """Return the pitch command as the pulses of output 1."""
    return _pulses(0, published_us(command.topic), {1: 1500.0 + 500.0 * command.axes["pitch"]})


def _pulses(port: int, at: IntArray, pulses: Mapping[int, FloatArray]) -> TimedMessages:
    fields: dict[str, ArrayLike] = {f"servo{k}_raw": values for k, values in pulses.items()}
    return TimedMessages("SERVO_OUTPUT_RAW", at, {"time_usec": at, "port": port, **fields})
