"""Air data and servo outputs of a PX4 log: SERVO_OUTPUT_RAW from outputs, servos or the pitch command.

PX4 publishes the outputs of each driver as an instance of ``actuator_outputs``, in the order in which the
drivers started. Only the outputs' movements show which instance belongs to PWM_MAIN, and which to PWM_AUX.

PX4 before 1.13 mixes its outputs by files that no log contains. The outputs are linear in the commands, so
that least squares of each output on the commands gives the mixer.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.vehicle.px4_wiring import (
    FOLLOWS_PITCH,
    OUTPUTS,
    STANDS_FOR_ELEVATOR,
    allocation,
    banks,
    px4_wiring,
    servo_outputs,
)
from advisor.mavlink.px4.px4_vehicle import (
    TimedMessages,
    Topic,
    Topics,
    best,
    first,
    joined,
    published_us,
    rate_hz,
    sampled_us,
    samples_of,
    vector,
)
from advisor.mavlink.records.equivalent import air_data, latest
from advisor.process.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Outputs:
    """Servo outputs of a log, with findings about them."""

    messages: Sequence[TimedMessages]
    as_parameters: Mapping[str, float]
    """Findings about the outputs in the form of parameters."""
    said: Sequence[str] = ()
    """Sentences for the user about the source of the outputs."""


def outputs(topics: Topics, parameters: Mapping[str, float]) -> Outputs:
    """Return the outputs that the parameters describe, else the outputs that follow the pitch command."""
    moving = _moving(topics.get("actuator_outputs", []))
    if any(role.surface for role in px4_wiring(parameters).roles.values()):
        return _of_surfaces(topics, moving, parameters)
    commands = pitch_commands(topics)
    for command in commands:
        for port, topic in enumerate(moving):
            senses = followers(topic, command)
            if senses and best((topic, command.topic)) is topic:
                numbered = {f"{FOLLOWS_PITCH}{16 * port + k}": sense for k, sense in senses.items()}
                return Outputs([_of_instance(n, topic) for n, topic in enumerate(moving)], numbered)
    if commands and _varies(commands[0].axes["pitch"]):
        pitch = {1: 1500.0 + 500.0 * commands[0].axes["pitch"]}
        pulses = _pulses(0, published_us(commands[0].topic), pitch)
        return Outputs([pulses], {f"{FOLLOWS_PITCH}1": STANDS_FOR_ELEVATOR})
    return Outputs([_of_instance(port, topic) for port, topic in enumerate(moving)], {})


def _of_surfaces(topics: Topics, moving: Sequence[Topic], parameters: Mapping[str, float]) -> Outputs:
    """Return the outputs from the fastest of outputs, servo commands and torque demand."""
    # By default PX4 logs outputs and servos every 100 ms, and the torque set point every 20 ms.
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
    """Return the instances in which any output moves; all if none moves."""
    moving = [topic for topic in instances if any(_moves(topic, k) for k in OUTPUTS)]
    return moving or list(instances)


def _moves(topic: Topic, k: int) -> bool:
    return _varies(topic[f"output[{k - 1}]"])


def _varies(values: FloatArray) -> bool:
    good = values[np.isfinite(values)]
    return len(good) > 0 and float(np.ptp(good)) > 0.0


def _assigned(instances: Sequence[Topic], parameters: Mapping[str, float]) -> dict[int, Topic]:
    """Return, for each output group, the instance (from 0) in which the moving outputs fit the group's
    functions best.
    """
    agreements = []
    for bank, group in enumerate(banks(parameters) or ["PWM_MAIN"]):
        used = {k for k in OUTPUTS if parameters.get(f"{group}_FUNC{k}")}
        for n, topic in enumerate(instances):
            agreements.append((sum(-1 if k in used else 1 for k in OUTPUTS if _moves(topic, k)), bank, n))
    assigned: dict[int, int] = {}
    for _, bank, n in sorted(agreements):
        if bank not in assigned and n not in assigned.values():
            assigned[bank] = n
    return {bank: instances[n] for bank, n in assigned.items()}


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


def _pulses(port: int, at: IntArray, pulses: Mapping[int, FloatArray]) -> TimedMessages:
    fields: dict[str, ArrayLike] = {f"servo{k}_raw": values for k, values in pulses.items()}
    return TimedMessages("SERVO_OUTPUT_RAW", at, {"time_usec": at, "port": port, **fields})


_FOLLOWS = 0.5
"""Least share of an output's movement that the pitch command must explain, after removal of other commands.
At 10 Hz two topics sample each step at different moments. The share is then about 0.8."""
_SMALLER = 0.3
"""Least effect of pitch on an output, over the largest effect on any output. A smaller effect belongs to a
mixer's trim, such as compensating flaps."""
_LEAST_SAMPLES = 20


@dataclass(frozen=True, slots=True)
class Command:
    """Commands of the attitude controller, -1 to 1."""

    name: str
    """Name of the topic."""
    topic: Topic
    axes: Mapping[str, FloatArray]
    """Shape (n,) each: roll, pitch, yaw and, if in the topic, throttle. Positive pitch raises the nose."""


def pitch_commands(topics: Topics) -> list[Command]:
    """Return the topics with the commands, the preferred first. For a VTOL aircraft, the wing's topic is
    last."""
    commands = []
    for topic in topics.get("actuator_controls_0", []):
        axes = dict(zip(("roll", "pitch", "yaw", "throttle"), vector(topic, "control", 4), strict=True))
        commands.append(Command("actuator_controls_0", topic, axes))
    for topic in topics.get("vehicle_torque_setpoint", []):
        axes = dict(zip(("roll", "pitch", "yaw"), vector(topic, "xyz", 3), strict=True))
        commands.append(Command("vehicle_torque_setpoint", topic, axes))
    return commands


def followers(outputs: Topic, command: Command) -> dict[int, float]:
    """Return 1.0 for each output that follows the pitch command, -1.0 for the opposite, by the output's
    number."""
    at, sent_us = published_us(outputs), published_us(command.topic)
    orders = {name: np.interp(at, sent_us, values) for name, values in command.axes.items()}
    inside = (at >= sent_us[0]) & (at <= sent_us[-1]) & np.all(np.isfinite([*orders.values()]), axis=0)
    axes = {name: values[inside] for name, values in orders.items()}
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


_SOURCES = ("airspeed_source", "selected_airspeed_index")
"""Fields of AirspeedValidated.msg with the source of the air speed, since 1.15 and before. The values 1 to 3
number a sensor, 0 is ground speed minus wind, 4 a synthetic speed, -1 none."""
_SENSORS = (1, 2, 3)
_CALIBRATED, _INDICATED = "calibrated_airspeed_m_s", "indicated_airspeed_m_s"
_TRUE = "true_airspeed_m_s"
_STANDS_IN = (
    "Air speed: no sensor measured it. The autopilot's own estimate is used instead; it does not show gusts"
)
_REFUSED = "Air speed: the autopilot calls its sensor invalid, and no other source gives the air speed"

BoolArray = NDArray[np.bool_]
Speed = dict[str, NDArray[Any]]
"""Fields of VFR_HUD with the air speed, each of shape (n,)."""
Series = tuple[IntArray, FloatArray]
"""Stamps in us since boot, and values, each of shape (n,)."""


def air(topics: Topics) -> tuple[list[TimedMessages], list[str]]:
    """Return VFR_HUD and WIND_COV, and sentences about the source of the air speed."""
    speed, said = _airspeed(topics)
    by_field = {"climb": _climb(topics), "throttle": _throttle(topics)}
    records = [{"time_usec": pair[0], name: pair[1]} for name, pair in by_field.items() if pair is not None]
    records = [*([speed] if speed is not None else []), *records]
    blown = _wind(topics)
    if not records:
        return blown, said
    fields: dict[str, ArrayLike] = dict(air_data(*records))
    return [TimedMessages("VFR_HUD", np.asarray(fields["time_usec"]), fields), *blown], said


def _airspeed(topics: Topics) -> tuple[Speed | None, list[str]]:
    """Return the validated or the sensor's air speed, whichever is faster, while a sensor is valid."""
    validated, raw = first(topics, "airspeed_validated"), topics.get("airspeed", [])
    measured = [] if validated is None else [samples_of(validated, _is_measured(validated))]
    sensor = joined(
        [samples_of(topic, _is_believed(topic, k, validated)) for k, topic in enumerate(raw, start=1)]
    )
    if sensor is not None:
        measured.append(sensor)
    chosen = best(topic for topic in measured if len(topic["timestamp"]))
    if chosen is not None:
        return _calibrated(chosen, validated), []
    estimated = None if validated is None else samples_of(validated, np.isfinite(validated[_CALIBRATED]))
    if estimated is not None and len(estimated["timestamp"]):
        return _calibrated(estimated, validated), [_STANDS_IN]
    return (_calibrated(raw[0], validated), [_REFUSED]) if raw else (None, [])


def _source(validated: Topic) -> FloatArray:
    """Return the number of the source at each sample; 1 where the topic has no such field."""
    for name in _SOURCES:
        if name in validated:
            return validated[name].astype(np.float64)
    return np.ones(len(validated["timestamp"]))


def _is_measured(validated: Topic) -> BoolArray:
    return np.isfinite(validated[_CALIBRATED]) & np.isin(_source(validated), _SENSORS)


def _is_believed(sensor: Topic, number: int, validated: Topic | None) -> BoolArray:
    """Return whether the autopilot uses this sensor number at each sample; sensor 1 without the field."""
    good = np.isfinite(sensor[_INDICATED])
    if validated is None:
        return good & (number == 1)
    source = _source(validated)
    at = latest(published_us(sensor), published_us(validated), source)
    return np.asarray(good & (np.where(np.isnan(at), source[0], at) == number))


def _calibrated(speed: Topic, validated: Topic | None) -> Speed:
    """Return the calibrated air speed (indicated speed times the validator's scale), with the true one."""
    scale = 1.0 if _CALIBRATED in speed else _scale(validated)
    fields = {"airspeed": _CALIBRATED if _CALIBRATED in speed else _INDICATED, "true_airspeed": _TRUE}
    speeds = {
        name: scale * speed[field].astype(np.float64) for name, field in fields.items() if field in speed
    }
    return {"time_usec": sampled_us(speed), **speeds}


def _scale(validated: Topic | None) -> float:
    """Return the validator's ratio of calibrated to indicated air speed; 1 where unknown."""
    scale = 1.0
    if validated is not None and _INDICATED in validated:
        with np.errstate(divide="ignore", invalid="ignore"):
            ratios = validated[_CALIBRATED] / validated[_INDICATED]
        good = np.isfinite(ratios) & _is_measured(validated)
        scale = float(np.median(ratios[good])) if good.any() else 1.0
    return scale


def _climb(topics: Topics) -> Series | None:
    """Return the climb rate of the position filter where valid, or of the global position in older logs."""
    local, globally = first(topics, "vehicle_local_position"), first(topics, "vehicle_global_position")
    if local is not None:
        valid = local["v_z_valid"] > 0 if "v_z_valid" in local else np.ones(len(local["vz"]), dtype=np.bool_)
        local = samples_of(local, valid)
    chosen = best(topic for topic in (local, globally) if topic is not None and len(topic["timestamp"]))
    if chosen is None:
        return None
    return sampled_us(chosen), -chosen["vz" if chosen is local else "vel_d"].astype(np.float64)


def _wind(topics: Topics) -> list[TimedMessages]:
    """Return WIND_COV, the estimated wind, from the topic since version 1.12 or from the earlier topic."""
    estimated = first(topics, "wind") or first(topics, "wind_estimate")
    if estimated is None:
        return []
    at = sampled_us(estimated)
    fields = {"wind_x": estimated["windspeed_north"], "wind_y": estimated["windspeed_east"]}
    return [TimedMessages("WIND_COV", at, {"time_usec": at, **fields})]


def _throttle(topics: Topics) -> Series | None:
    """Return the throttle in percent: thrust along the body's x axis, or older logs' throttle command."""
    thrust, lever = first(topics, "vehicle_thrust_setpoint"), first(topics, "actuator_controls_0")
    chosen = thrust or lever
    if chosen is None:
        return None
    return published_us(chosen), 100.0 * chosen["xyz[0]" if thrust else "control[3]"].astype(np.float64)
