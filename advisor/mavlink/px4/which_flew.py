"""Choice of the sensors and the estimator with which the autopilot flew, among several in a PX4 log.

``estimator_selector_status.primary_instance`` numbers the estimator. ``sensor_selection`` names sensors by
device. Topics are those of PX4's message definitions (msg/*.msg).
"""

from collections.abc import Mapping, Sequence

import numpy as np

from advisor.mavlink.px4.px4_topics import Topic, Topics, first, joined, published_us, samples_of
from advisor.mavlink.records.equivalent import latest
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.vehicle_time import clock

_ESTIMATES = {
    "vehicle_attitude": "estimator_attitude",
    "vehicle_local_position": "estimator_local_position",
    "vehicle_global_position": "estimator_global_position",
    "wind": "estimator_wind",
}
"""Topic of the single estimators, by the topic of the estimator in use. The topic of the estimator in use is
preferred.
"""
_DEVICES = {
    "sensor_accel": (
        ("Accelerometer", "device_id"),
        ("sensor_selection", "accel_device_id"),
        ("sensors_status_imu", "accel_device_id_primary"),
    ),
    "vehicle_air_data": (
        ("Barometer", "baro_device_id"),
        ("sensor_selection", "baro_device_id"),
        ("sensors_status_baro", "device_id_primary"),
    ),
}
"""Sensor's field with the device, then topics and fields with the device in use, by the sensor's topic. The
first topic that is logged counts.
"""
SELECTORS: Mapping[str, set[str]] = {
    "estimator_selector_status": {"primary_instance"},
    "estimator_attitude": {"q[3]"},
    "estimator_local_position": {"z", "vz"},
    "estimator_global_position": {"vel_d"},
    "estimator_wind": {"windspeed_north", "windspeed_east"},
    "sensor_selection": {"accel_device_id"},
    "sensors_status_baro": {"device_id_primary"},
    "sensors_status_imu": {"accel_device_id_primary"},
}
"""Necessary fields of the topics that tell which sensor or estimator flew, by the topic's name."""
_MOST_CHANGES = 5
"""Largest number of sentences about changes of one sensor or estimator."""


def as_flown(topics: Topics) -> tuple[dict[str, list[Topic]], list[str]]:
    """Return the topics, with the instance in use at each time as the first instance, and sentences about
    changes.
    """
    flown = {name: list(instances) for name, instances in topics.items()}
    said: list[str] = []
    status = first(topics, "estimator_selector_status")
    numbers = None if status is None else status["primary_instance"].astype(np.float64)
    for name, single in _ESTIMATES.items():
        instances = topics.get(name) or topics.get(single) or []
        if status is not None and numbers is not None and len(instances) > 1:
            flown[name] = [_in_use(instances, range(len(instances)), published_us(status), numbers)]
        elif instances:
            flown[name] = [instances[0]]
    if status is not None and numbers is not None:
        said += _changes("Estimator: instance", published_us(status), numbers)
    for name, ((sensor, own), *places) in _DEVICES.items():
        instances = topics.get(name, [])
        devices = [float(instance[own][0]) if own in instance else np.nan for instance in instances]
        for selector, field in places:
            stated = first(topics, selector)
            if stated is None or field not in stated:
                continue
            device = stated[field].astype(np.float64)
            if len(instances) > 1:
                flown[name] = [_in_use(instances, devices, published_us(stated), device)]
            order = {number: place for place, number in enumerate(dict.fromkeys(devices))}
            place_of = np.array([order.get(number, np.nan) for number in device])
            if not np.isnan(place_of).any():
                said += _changes(f"{sensor}: instance", published_us(stated), place_of)
            break
    return flown, said


def _in_use(instances: Sequence[Topic], names: Sequence[float], at_us: IntArray, stated: FloatArray) -> Topic:
    """Return the samples of the stated instance at each time. If no instance is ever stated, return the first
    instance.
    """
    parts = []
    for name, instance in zip(names, instances, strict=True):
        now = latest(published_us(instance), at_us, stated)
        parts.append(samples_of(instance, np.where(np.isnan(now), stated[0], now) == name))
    whole = joined(parts)
    return whole if whole is not None and len(whole["timestamp"]) else instances[0]


def _changes(what: str, at_us: IntArray, numbers: FloatArray) -> list[str]:
    """Return sentences about the first instance in use and its changes; none if only instance 0
    was in use.
    """
    rows = np.flatnonzero(np.diff(numbers, prepend=np.nan) != 0.0)
    if numbers[rows].tolist() in ([], [0.0]):
        return []
    said = [
        f"{what} {numbers[row]:.0f} flew" + (f" since {clock(at_us[row] / 1e6)}" if row else "")
        for row in rows[:_MOST_CHANGES].tolist()
    ]
    more = len(rows) - len(said)
    return [*said[:-1], f"{said[-1]}, and {more} more changes follow"] if more else said
