"""What a PX4 log says, as the messages its telemetry would have carried.

Topics and fields are those of PX4's message definitions (msg/*.msg).
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.messages import FloatArray, IntArray
from advisor.mavlink.equivalent import MAV_PARAM_TYPE_REAL32, MAV_TYPE_FIXED_WING, latest

TOPICS: dict[str, set[str]] = {
    "actuator_controls_0": {"control[3]"},
    "actuator_outputs": {"output[15]"},
    "airspeed": {"indicated_airspeed_m_s"},
    "airspeed_validated": {"calibrated_airspeed_m_s"},
    "debug_key_value": {"key[9]", "value"},
    "input_rc": {"values[17]"},
    "sensor_combined": {"gyro_rad[2]", "accelerometer_m_s2[2]"},
    "vehicle_angular_velocity": {"xyz[2]"},
    "vehicle_attitude": {"q[3]"},
    "vehicle_gps_position": {"time_utc_usec"},
    "vehicle_local_position": {"z", "vz"},
    "vehicle_status": {"nav_state"},
    "vehicle_thrust_setpoint": {"xyz[0]"},
}
"""Topics, and the fields needed of each: without them (another version) a topic counts as missing."""

_PX4 = 12  # MAV_AUTOPILOT
_MAV_TYPE_QUADROTOR = 2
_ROTARY_WING = 1  # vehicle_status.vehicle_type
_MAIN_MODES = {0: 1, 1: 2, 2: 3, 10: 5, 14: 6, 15: 7}
"""vehicle_status.nav_state to the main mode of PX4's custom_mode: manual, altitude, position, acro,
offboard, stabilised; any other is automatic."""
_AUTO = 4

Topic = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, slots=True)
class TimedMessages:
    """Messages of one type, by the autopilot's clock."""

    name: str
    time_us: IntArray
    """Shape (n,), microseconds since boot, in any order, as the fields."""
    fields: Mapping[str, ArrayLike]


def translate(log: Any) -> list[TimedMessages]:
    """Every message that the topics of a `pyulog.ULog` give."""
    topics = _topics(log)
    first = {name: instances[0] for name, instances in topics.items()}
    messages = [
        *_attitude(first),
        *_highres_imu(first),
        *_vfr_hud(first),
        *_heights(first),
        *_named_values(first),
        *_receiver(first),
        *(_outputs(port, topic) for port, topic in enumerate(topics.get("actuator_outputs", []))),
        *_texts(log),
    ]
    start_us = min((int(np.min(m.time_us)) for m in messages), default=0)
    return [
        _heartbeat(first, log.initial_parameters, start_us),
        *_version(log, start_us),
        *_parameters(log, start_us),
        *messages,
    ]


def unix_time_base_s(log: Any) -> float:
    """Seconds since 1970 at boot, from the first fix that has a date; 0 when there is none."""
    for fixes in _topics(log).get("vehicle_gps_position", []):
        for utc_us, boot_us in zip(fixes["time_utc_usec"].tolist(), fixes["timestamp"].tolist(), strict=True):
            if utc_us > 0:
                return float(utc_us - boot_us) * 1e-6
    return 0.0


def _topics(log: Any) -> dict[str, list[Topic]]:
    """The instances of each topic that have the fields needed, in the order of their time."""
    topics: dict[str, list[Topic]] = {}
    for data in sorted(log.data_list, key=lambda data: (data.name, data.multi_id)):
        if {"timestamp"} | TOPICS[data.name] <= data.data.keys():
            by_time = np.argsort(data.data["timestamp"], kind="stable")
            topics.setdefault(data.name, []).append({name: v[by_time] for name, v in data.data.items()})
    return topics


def _time_us(topic: Topic, field: str = "timestamp") -> IntArray:
    return topic[field].astype(np.int64)


def _sampled_us(topic: Topic) -> IntArray:
    """When the sensor was read, where the topic says; otherwise when it was published."""
    published = _time_us(topic)
    if "timestamp_sample" not in topic:
        return published
    sampled = _time_us(topic, "timestamp_sample")
    return np.where(sampled > 0, sampled, published)


def _attitude(topics: Mapping[str, Topic]) -> Iterator[TimedMessages]:
    """Angles at the stamps of the attitude, rates at those of the angular velocity."""
    blocks: list[tuple[IntArray, NDArray[np.float64]]] = []
    attitude = topics.get("vehicle_attitude")
    if attitude is not None:
        angles = _euler(*(attitude[f"q[{i}]"].astype(np.float64) for i in range(4)))
        blocks.append((_sampled_us(attitude), np.vstack([angles, np.full_like(angles, np.nan)])))
    rates_topic = topics.get("vehicle_angular_velocity")
    if rates_topic is not None:
        rates = np.array([rates_topic[f"xyz[{i}]"] for i in range(3)], dtype=np.float64)
        blocks.append((_sampled_us(rates_topic), np.vstack([np.full_like(rates, np.nan), rates])))
    elif "sensor_combined" in topics:
        sensors = topics["sensor_combined"]
        rates = np.array([sensors[f"gyro_rad[{i}]"] for i in range(3)], dtype=np.float64)
        blocks.append((_time_us(sensors), np.vstack([np.full_like(rates, np.nan), rates])))
    if not blocks:
        return
    time_us = np.concatenate([time_us for time_us, _ in blocks])
    values = np.hstack([values for _, values in blocks])
    names = ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
    fields: dict[str, ArrayLike] = {"time_boot_ms": _milliseconds(time_us)}
    yield TimedMessages("ATTITUDE", time_us, fields | dict(zip(names, values, strict=True)))


def _euler(w: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Roll, pitch and yaw of attitude quaternions (body to north-east-down), shape (3, n), rad."""
    roll = np.arctan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    return np.array([roll, pitch, yaw])


def _highres_imu(topics: Mapping[str, Topic]) -> Iterator[TimedMessages]:
    if "sensor_combined" in topics:
        sensors = topics["sensor_combined"]
        fields: dict[str, ArrayLike] = {"time_usec": _time_us(sensors)}
        for i, axis in enumerate("xyz"):
            fields[f"{axis}acc"] = sensors[f"accelerometer_m_s2[{i}]"]
            fields[f"{axis}gyro"] = sensors[f"gyro_rad[{i}]"]
        yield TimedMessages("HIGHRES_IMU", _time_us(sensors), fields)


def _vfr_hud(topics: Mapping[str, Topic]) -> Iterator[TimedMessages]:
    air = topics.get("airspeed_validated", topics.get("airspeed"))
    if air is None:
        return
    at = _time_us(air)
    fields: dict[str, ArrayLike] = {
        "airspeed": air.get("calibrated_airspeed_m_s", air.get("indicated_airspeed_m_s", np.nan)),
        "climb": -_known(at, topics.get("vehicle_local_position"), "vz"),
        "alt": -_known(at, topics.get("vehicle_local_position"), "z"),
    }
    thrust = _known(at, topics.get("vehicle_thrust_setpoint"), "xyz[0]")
    lever = _known(at, topics.get("actuator_controls_0"), "control[3]")
    fields["throttle"] = 100.0 * np.where(np.isnan(thrust), lever, thrust)
    yield TimedMessages("VFR_HUD", at, fields)


def _known(at_us: IntArray, topic: Topic | None, field: str) -> FloatArray:
    if topic is None or field not in topic:
        return np.full(len(at_us), np.nan)
    return latest(at_us, _time_us(topic), topic[field])


def _heights(topics: Mapping[str, Topic]) -> Iterator[TimedMessages]:
    position = topics.get("vehicle_local_position")
    if position is not None:
        at = _sampled_us(position)
        fields: dict[str, ArrayLike] = {"time_boot_ms": _milliseconds(at)}
        fields["relative_alt"] = -1e3 * position["z"].astype(np.float64)
        yield TimedMessages("GLOBAL_POSITION_INT", at, fields)


def _named_values(topics: Mapping[str, Topic]) -> Iterator[TimedMessages]:
    values = topics.get("debug_key_value")
    if values is not None:
        letters = np.stack([values[f"key[{i}]"].astype(np.uint8) for i in range(10)], axis=1)
        names = [row.tobytes().partition(b"\0")[0] for row in letters]
        at = _time_us(values)
        yield TimedMessages(
            "NAMED_VALUE_FLOAT",
            at,
            {"time_boot_ms": _milliseconds(at), "name": np.array(names, "S10"), "value": values["value"]},
        )


def _receiver(topics: Mapping[str, Topic]) -> Iterator[TimedMessages]:
    received = topics.get("input_rc")
    if received is not None:
        at = _time_us(received)
        pulses: dict[str, ArrayLike] = {f"chan{i + 1}_raw": received[f"values[{i}]"] for i in range(18)}
        yield TimedMessages("RC_CHANNELS", at, {"time_boot_ms": _milliseconds(at), **pulses})


def _outputs(port: int, topic: Topic) -> TimedMessages:
    at = _time_us(topic)
    pulses: dict[str, ArrayLike] = {f"servo{i + 1}_raw": topic[f"output[{i}]"] for i in range(16)}
    return TimedMessages("SERVO_OUTPUT_RAW", at, {"time_usec": at, "port": port, **pulses})


def _mav_type(parameters: Mapping[str, Any], status: Topic | None) -> int:
    """MAV_TYPE as the parameter states, else as vehicle_status does: by vehicle_type, once by is_rotary_wing.

    A VTOL aircraft says rotary wing while it hovers; its elevator is there all the same.
    """
    stated = parameters.get("MAV_TYPE")
    if isinstance(stated, int | float) and stated in range(1, 256):
        return int(stated)
    if status is None or np.any(status.get("is_vtol", 0)):
        return MAV_TYPE_FIXED_WING
    rotary = status.get("is_rotary_wing", status.get("vehicle_type", np.zeros(1)) == _ROTARY_WING)
    return _MAV_TYPE_QUADROTOR if np.all(rotary) else MAV_TYPE_FIXED_WING


def _heartbeat(topics: Mapping[str, Topic], parameters: Mapping[str, Any], start_us: int) -> TimedMessages:
    """One before everything else, so that the vehicle is known, then as the mode may change."""
    status = topics.get("vehicle_status")
    at, states = np.array([start_us]), np.zeros(1, np.int64)
    if status is not None:
        rows = np.concatenate([[0], np.arange(len(status["timestamp"]))])
        at = np.concatenate([at, _time_us(status)])
        states = status["nav_state"].astype(np.int64)[rows]
    mains = np.array([_MAIN_MODES.get(state, _AUTO) for state in states.tolist()])
    fields: dict[str, ArrayLike] = {
        "type": _mav_type(parameters, status),
        "autopilot": _PX4,
        "base_mode": 1,
        "custom_mode": mains << 16,
    }
    return TimedMessages("HEARTBEAT", at, fields)


def _parameters(log: Any, start_us: int) -> Iterator[TimedMessages]:
    rows = [(start_us, name, value) for name, value in log.initial_parameters.items()]
    rows += [(max(at, start_us), name, value) for at, name, value in log.changed_parameters]
    rows = [row for row in rows if isinstance(row[2], int | float)]
    if not rows:
        return
    fields: dict[str, ArrayLike] = {
        "param_id": np.array([name.encode() for _, name, _ in rows], "S16"),
        "param_value": np.array([value for *_, value in rows], np.float64),
        "param_type": MAV_PARAM_TYPE_REAL32,
        "param_count": len(log.initial_parameters),
    }
    yield TimedMessages("PARAM_VALUE", _stamps(at for at, *_ in rows), fields)


def _texts(log: Any) -> Iterator[TimedMessages]:
    texts = log.logged_messages
    if texts:
        fields: dict[str, ArrayLike] = {
            "severity": np.array([text.log_level - ord("0") for text in texts]),
            "text": np.array([text.message.encode() for text in texts]),
        }
        yield TimedMessages("STATUSTEXT", _stamps(text.timestamp for text in texts), fields)


def _version(log: Any, start_us: int) -> Iterator[TimedMessages]:
    release = log.msg_info_dict.get("ver_sw_release")
    if isinstance(release, int):
        yield TimedMessages("AUTOPILOT_VERSION", np.array([start_us]), {"flight_sw_version": release})


def _stamps(times_us: Iterable[int]) -> IntArray:
    """As an array; the 64th bit, which only a damaged stamp can have, is dropped."""
    return np.array([time_us & (1 << 63) - 1 for time_us in times_us], dtype=np.int64)


def _milliseconds(time_us: IntArray) -> IntArray:
    return (time_us + 500) // 1000
