"""Topics of a PX4 log, and the identity of its vehicle: kind, modes, firmware, parameters, texts.

Topics and fields are those of PX4's message definitions (msg/*.msg).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.stream.identity import READER
from advisor.mavlink.records.equivalent import MAV_PARAM_TYPE_REAL32, MAV_TYPE_FIXED_WING, milliseconds
from advisor.process.arrays import FloatArray, IntArray

TOPICS: dict[str, set[str]] = {
    "actuator_controls_0": {"control[3]"},
    "actuator_outputs": {"output[15]"},
    "actuator_servos": {"control[7]"},
    "airspeed": {"indicated_airspeed_m_s"},
    "airspeed_validated": {"calibrated_airspeed_m_s"},
    "debug_key_value": {"key[9]", "value"},
    "input_rc": {"values[17]"},
    "sensor_accel": {"x", "y", "z"},
    "sensor_combined": {"gyro_rad[2]", "accelerometer_m_s2[2]"},
    "vehicle_acceleration": {"xyz[2]"},
    "vehicle_angular_velocity": {"xyz[2]"},
    "vehicle_attitude": {"q[3]"},
    "vehicle_global_position": {"vel_d"},
    "vehicle_gps_position": {"time_utc_usec"},
    "vehicle_air_data": {"baro_pressure_pa"},
    "vehicle_local_position": {"z", "vz"},
    "vehicle_status": {"nav_state"},
    "vehicle_thrust_setpoint": {"xyz[0]"},
    "vehicle_torque_setpoint": {"xyz[2]"},
    "wind": {"windspeed_north", "windspeed_east"},
    "wind_estimate": {"windspeed_north", "windspeed_east"},
}
"""Necessary fields of each topic, by the topic's name. A topic without its necessary fields (another version)
counts as missing."""

ENOUGH_HZ = 25.0
"""Least rate at which the preferred topic is used although another is faster, 1/s. PX4's filtered rates come
at 50 Hz by default, its raw gyro at 200 Hz."""

Topic = Mapping[str, NDArray[Any]]
Topics = Mapping[str, Sequence[Topic]]


@dataclass(frozen=True, slots=True)
class TimedMessages:
    """Messages of one type, stamped by the autopilot's clock."""

    name: str
    time_us: IntArray
    """Shape (n,), microseconds since boot, in the order of the fields."""
    fields: Mapping[str, ArrayLike]


def topics_of(log: Any, needed: Mapping[str, set[str]] = TOPICS) -> dict[str, list[Topic]]:
    """Return the instances of each topic with its ``needed`` fields, in order of time."""
    topics: dict[str, list[Topic]] = {}
    for data in sorted(log.data_list, key=lambda data: (data.name, data.multi_id)):
        if {"timestamp"} | needed[data.name] <= data.data.keys() and len(data.data["timestamp"]):
            by_time = np.argsort(data.data["timestamp"], kind="stable")
            topics.setdefault(data.name, []).append(
                {name: _wide(v[by_time]) for name, v in data.data.items()}
            )
    return topics


def _wide(values: NDArray[Any]) -> NDArray[Any]:
    """Return floating-point values in double precision. NumPy gives no warning for a damaged value."""
    return values.astype(np.float64) if values.dtype.kind == "f" else values


def first(topics: Topics, name: str) -> Topic | None:
    """Return the first instance of a topic, None where the log has none."""
    return topics[name][0] if name in topics else None


def published_us(topic: Topic) -> IntArray:
    """Return the times of publication of a topic's samples, us since boot."""
    return topic["timestamp"].astype(np.int64)


def sampled_us(topic: Topic) -> IntArray:
    """Return the times of the sensor's readings if the topic has them, else the times of publication."""
    published = published_us(topic)
    if "timestamp_sample" not in topic:
        return published
    sampled = topic["timestamp_sample"].astype(np.int64)
    return np.where(sampled > 0, sampled, published)


def vector(topic: Topic, name: str, size: int) -> FloatArray:
    """Return an array field, shape (size, n)."""
    return np.array([topic[f"{name}[{i}]"] for i in range(size)], dtype=np.float64)


def samples_of(topic: Topic, which: NDArray[np.bool_]) -> Topic:
    """Return the samples of a topic that ``which`` selects."""
    return {name: values[which] for name, values in topic.items()}


def joined(topics: Sequence[Topic]) -> Topic | None:
    """Return samples of several sensors that were used one after the other, in the order of time."""
    if not topics:
        return None
    names = set.intersection(*(set(topic) for topic in topics))
    whole = {name: np.concatenate([topic[name] for topic in topics]) for name in names}
    by_time = np.argsort(whole["timestamp"], kind="stable")
    return {name: values[by_time] for name, values in whole.items()}


def rate_hz(topic: Topic) -> float:
    """Return the sampling rate from the typical interval, Hz; 0 with fewer than two samples."""
    if len(topic["timestamp"]) < 2:
        return 0.0
    return 1e6 / max(float(np.median(np.diff(published_us(topic)))), 1.0)


def best(candidates: Iterable[Topic | None]) -> Topic | None:
    """Return the first topic that is fast enough, else the fastest topic; None without a topic."""
    topics = [topic for topic in candidates if topic is not None]
    fast = [topic for topic in topics if rate_hz(topic) >= ENOUGH_HZ]
    return fast[0] if fast else max(topics, key=rate_hz, default=None)


_PX4 = 12  # MAV_AUTOPILOT
_MAV_TYPE_QUADROTOR = 2
_ROTARY_WING = 1  # vehicle_status.vehicle_type
_HOVER, _FORWARD = 3, 4  # MAV_VTOL_STATE
_MANUAL, _ALTITUDE, _POSITION, _AUTO, _ACRO, _OFFBOARD, _STABILISED, _TERMINATION = 1, 2, 3, 4, 5, 6, 7, 10
_MODES = {
    0: (_MANUAL, 0),
    1: (_ALTITUDE, 0),
    2: (_POSITION, 0),
    3: (_AUTO, 4),
    4: (_AUTO, 3),
    5: (_AUTO, 5),
    6: (_POSITION, 2),
    10: (_ACRO, 0),
    12: (_AUTO, 6),
    13: (_TERMINATION, 0),
    14: (_OFFBOARD, 0),
    15: (_STABILISED, 0),
    17: (_AUTO, 2),
    18: (_AUTO, 6),
    19: (_AUTO, 8),
    20: (_AUTO, 9),
    21: (_POSITION, 1),
    22: (_AUTO, 10),
}
"""Main and sub mode of PX4's custom_mode for each vehicle_status.nav_state (px4_custom_mode.h). All other
states are automatic."""
_KEY_BYTES = 10


def unix_time_base_s(topics: Topics) -> float:
    """Return the time of boot, seconds since 1970, from the first fix with a date; 0 without one."""
    for fixes in topics.get("vehicle_gps_position", []):
        for utc_us, boot_us in zip(fixes["time_utc_usec"].tolist(), fixes["timestamp"].tolist(), strict=True):
            if utc_us > 0:
                return float(utc_us - boot_us) * 1e-6
    return 0.0


def heartbeat(topics: Topics, parameters: Mapping[str, Any], start_us: int) -> TimedMessages:
    """Return a heartbeat before all other messages, then one at each status."""
    status = first(topics, "vehicle_status")
    at, states = np.array([start_us]), np.zeros(1, np.int64)
    if status is not None:
        samples = np.concatenate([[0], np.arange(len(status["timestamp"]))])
        at = np.concatenate([at, published_us(status)])
        states = status["nav_state"].astype(np.int64)[samples]
    modes = np.array([_MODES.get(state, (_AUTO, 0)) for state in states.tolist()])
    fields: dict[str, ArrayLike] = {
        "type": _mav_type(parameters, status),
        "autopilot": _PX4,
        "base_mode": 1,
        "custom_mode": modes[:, 0] << 16 | modes[:, 1] << 24,
    }
    return TimedMessages("HEARTBEAT", at, fields)


def vtol_states(topics: Topics) -> Iterator[TimedMessages]:
    """Yield EXTENDED_SYS_STATE of a VTOL aircraft: whether rotors or the wing carry it."""
    status = first(topics, "vehicle_status")
    if status is not None and np.any(status.get("is_vtol", 0)):
        rotors = _on_rotors(status) | (status.get("in_transition_mode", np.zeros(1)) > 0)
        state = np.where(rotors, _HOVER, _FORWARD)
        yield TimedMessages("EXTENDED_SYS_STATE", published_us(status), {"vtol_state": state})


def _on_rotors(status: Topic) -> NDArray[np.bool_]:
    """Return whether rotors carry the vehicle, from vehicle_type or from the older is_rotary_wing."""
    if "is_rotary_wing" in status:
        return np.asarray(status["is_rotary_wing"] > 0)
    return np.asarray(status.get("vehicle_type", np.zeros(len(status["timestamp"]))) == _ROTARY_WING)


def _mav_type(parameters: Mapping[str, Any], status: Topic | None) -> int:
    """Return MAV_TYPE of the parameters, else of vehicle_status. In vehicle_status a hovering VTOL is no
    aeroplane.
    """
    stated = parameters.get("MAV_TYPE")
    if isinstance(stated, int | float) and stated in range(1, 256):
        return int(stated)
    if status is None or np.any(status.get("is_vtol", 0)):
        return MAV_TYPE_FIXED_WING
    return _MAV_TYPE_QUADROTOR if np.all(_on_rotors(status)) else MAV_TYPE_FIXED_WING


def parameters_of(log: Any) -> dict[str, float]:
    """Return the numeric parameters at the beginning of the log."""
    initial = log.initial_parameters.items()
    return {name: float(v) for name, v in initial if isinstance(v, int | float) and isfinite(v)}


def dropouts(log: Any) -> list[str]:
    """Return a sentence about times in which the logger could not write; empty without such a time."""
    lasted_s = [dropout.duration * 1e-3 for dropout in log.dropouts]
    if not lasted_s:
        return []
    return [
        f"Logging dropped out {len(lasted_s)} times, for {max(lasted_s):.2f} s at the longest: use a faster "
        "card, or log less (SDLOG_PROFILE)"
    ]


def stated(log: Any, further: Mapping[str, float], start_us: int) -> Iterator[TimedMessages]:
    """Yield PARAM_VALUE of every parameter at the start of the log, then of every change."""
    initial = parameters_of(log)
    rows = [(start_us, name, value) for name, value in (initial | dict(further)).items()]
    rows += [
        (max(at, start_us), name, value)
        for at, name, value in log.changed_parameters
        if isinstance(value, int | float)
    ]
    if rows:
        fields: dict[str, ArrayLike] = {
            "param_id": np.array([name.encode() for _, name, _ in rows], "S16"),
            "param_value": np.array([value for *_, value in rows], np.float64),
            "param_type": MAV_PARAM_TYPE_REAL32,
            "param_count": len(initial),
        }
        yield TimedMessages("PARAM_VALUE", _stamps(at for at, *_ in rows), fields)


def texts(log: Any) -> Iterator[TimedMessages]:
    """Yield STATUSTEXT with the vehicle's own texts."""
    yield from _said(
        [(text.timestamp, text.log_level - ord("0"), text.message.encode()) for text in log.logged_messages]
    )


def remarks(said: Sequence[str], start_us: int) -> Iterator[TimedMessages]:
    """Yield STATUSTEXT with the sentences of the log's reader."""
    yield from _said([(start_us, 6, READER + text.encode()) for text in said])


def _said(rows: Sequence[tuple[int, int, bytes]]) -> Iterator[TimedMessages]:
    """Yield STATUSTEXT messages from rows of time in us, severity and text."""
    if rows:
        fields: dict[str, ArrayLike] = {
            "severity": np.array([level for _, level, _ in rows]),
            "text": np.array([text for *_, text in rows]),
        }
        yield TimedMessages("STATUSTEXT", _stamps(at for at, *_ in rows), fields)


def version(log: Any, start_us: int) -> Iterator[TimedMessages]:
    """Yield AUTOPILOT_VERSION if the log states a release."""
    release = log.msg_info_dict.get("ver_sw_release")
    if isinstance(release, int):
        yield TimedMessages("AUTOPILOT_VERSION", np.array([start_us]), {"flight_sw_version": release})


def named_values(topics: Topics) -> Iterator[TimedMessages]:
    """Yield NAMED_VALUE_FLOAT, as a vane may send its angle."""
    values = first(topics, "debug_key_value")
    if values is not None:
        letters = np.stack([values[f"key[{i}]"].astype(np.uint8) for i in range(_KEY_BYTES)], axis=1)
        names = [row.tobytes().partition(b"\0")[0] for row in letters]
        at = published_us(values)
        yield TimedMessages(
            "NAMED_VALUE_FLOAT",
            at,
            {"time_boot_ms": milliseconds(at), "name": np.array(names, "S10"), "value": values["value"]},
        )


def receiver(topics: Topics) -> Iterator[TimedMessages]:
    """Yield RC_CHANNELS with the pilot's sticks and switches."""
    received = first(topics, "input_rc")
    if received is not None:
        at = published_us(received)
        pulses: dict[str, NDArray[Any]] = {f"chan{i + 1}_raw": received[f"values[{i}]"] for i in range(18)}
        yield TimedMessages("RC_CHANNELS", at, {"time_boot_ms": milliseconds(at), **pulses})


def _stamps(times_us: Iterable[int]) -> IntArray:
    """Return the times as an array, without the 64th bit, which only a damaged stamp can have."""
    return np.array([time_us & (1 << 63) - 1 for time_us in times_us], dtype=np.int64)
