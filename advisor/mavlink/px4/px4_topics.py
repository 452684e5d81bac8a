"""Topics of a PX4 log: instances, stamps, and the choice among topics of one quantity.

Topics and fields are those of PX4's message definitions (msg/*.msg).
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

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
