"""PX4's own log (``.ulg``), read by pyulog.

``estimator_selector_status.primary_instance`` numbers the estimator with which the autopilot flew.
``sensor_selection`` names the sensors by device. Topics are those of PX4's message definitions (msg/*.msg).
"""

import contextlib
import io
import struct
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from advisor.flight.signals.clocks import euler_angles
from advisor.flight.signals.messages import Columns
from advisor.mavlink.px4 import px4_vehicle
from advisor.mavlink.px4.px4_outputs import air, outputs
from advisor.mavlink.px4.px4_vehicle import (
    TOPICS,
    TimedMessages,
    Topic,
    Topics,
    best,
    first,
    joined,
    published_us,
    sampled_us,
    samples_of,
    topics_of,
    unix_time_base_s,
    vector,
)
from advisor.mavlink.records.equivalent import latest, message, milliseconds, side_by_side, system_id
from advisor.process.arrays import FloatArray, IntArray
from advisor.words.mends import mends_of, sentence
from advisor.words.problems import UnusableInputError
from advisor.words.quantities import clock

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


_READ = {**TOPICS, **SELECTORS}
"""Necessary fields of each topic that is read, by the topic's name."""
_RATES = ("rollspeed", "pitchspeed", "yawspeed")


def motion(topics: Topics, is_turned: bool = False) -> Iterator[TimedMessages]:
    """Yield attitude, specific force, static pressure and height, if the log has their values.

    Parameters
    ----------
    is_turned
        Whether the board is mounted rotated. A raw sensor's axes then differ from the body axes.
    """
    yield from _attitude(topics)
    yield from _highres_imu(topics, is_turned)
    air = first(topics, "vehicle_air_data")
    if air is not None:
        at, hectopascal = sampled_us(air), 0.01 * air["baro_pressure_pa"]
        yield TimedMessages(
            "SCALED_PRESSURE", at, {"time_boot_ms": milliseconds(at), "press_abs": hectopascal}
        )
    position = first(topics, "vehicle_local_position")
    if position is not None:
        at = sampled_us(position)
        height_mm = -1e3 * position["z"].astype(np.float64)
        yield TimedMessages(
            "GLOBAL_POSITION_INT", at, {"time_boot_ms": milliseconds(at), "relative_alt": height_mm}
        )


def _attitude(topics: Topics) -> Iterator[TimedMessages]:
    """Yield angles at the stamps of the attitude, and rates at the stamps of the angular velocity or of the
    gyro.
    """
    records = []
    attitude = first(topics, "vehicle_attitude")
    if attitude is not None:
        records.append({"time_us": sampled_us(attitude), **euler_angles(vector(attitude, "q", 4))})
    turning, gyro = first(topics, "vehicle_angular_velocity"), first(topics, "sensor_combined")
    # PX4 before 1.9 has the rates in vehicle_attitude.
    former = attitude if attitude is not None and set(_RATES) <= attitude.keys() else None
    chosen = best((turning, gyro, former))
    if chosen is not None and chosen is former:
        rates = np.array([chosen[name] for name in _RATES], dtype=np.float64)
    elif chosen is not None:
        rates = vector(chosen, "xyz" if chosen is turning else "gyro_rad", 3)
    if chosen is not None:
        records.append({"time_us": sampled_us(chosen), **dict(zip(_RATES, rates, strict=True))})
    if records:
        fields: dict[str, ArrayLike] = dict(side_by_side(*records))
        time_us = np.asarray(fields.pop("time_us"))
        yield TimedMessages("ATTITUDE", time_us, {"time_boot_ms": milliseconds(time_us), **fields})


def _highres_imu(topics: Topics, is_turned: bool) -> Iterator[TimedMessages]:
    """Yield the specific force at the stamps of the accelerometer."""
    raw, filtered = first(topics, "sensor_combined"), first(topics, "vehicle_acceleration")
    sensor = None if is_turned else first(topics, "sensor_accel")
    chosen = best((raw, filtered, sensor))
    if chosen is None:
        return
    at = published_us(chosen) if chosen is raw else sampled_us(chosen)
    if chosen is sensor:
        force = np.array([chosen[axis] for axis in "xyz"], dtype=np.float64)
    else:
        force = vector(chosen, "accelerometer_m_s2" if chosen is raw else "xyz", 3)
    fields: dict[str, ArrayLike] = {"time_usec": at}
    fields |= dict(zip(("xacc", "yacc", "zacc"), force, strict=True))
    yield TimedMessages("HIGHRES_IMU", at, fields)


MAGIC = b"ULog\x01\x12\x35"


class WholeFile(io.BufferedReader):
    """A file in which a read beyond the end fails.

    Without this failure, pyulog 1.3 steps back by the bytes that it requested, not by the bytes that it got.
    The search in a damaged file would then never end.
    """

    def read(self, size: int | None = -1, /) -> bytes:
        """Return exactly ``size`` bytes, or none at the end."""
        data = super().read(size)
        if size is not None and 0 < len(data) < size:
            raise struct.error
        return data


def read_ulog(path: Path, wanted: Iterable[str] | None = None, starts_at: int = 0) -> Iterator[list[Columns]]:
    """Yield the messages of a ``.ulg``, in one batch, ordered by time.

    Parameters
    ----------
    path
    wanted
        Names of the messages to return. None for all messages.
    starts_at
        Number of bytes in the file before the log.

    Raises
    ------
    UnusableInputError
        The file contains neither attitude, sensors, nor outputs.
    """
    from pyulog import ULog  # here, for no other command needs to wait for its import

    try:
        # pyulog prints its warnings; standard output belongs to the result.
        raw = io.FileIO(path) if starts_at == 0 else io.BytesIO(path.read_bytes()[starts_at:])
        with WholeFile(raw) as file, contextlib.redirect_stdout(sys.stderr):
            log = ULog(file, list(_READ))
    except Exception as error:  # whatever pyulog meets in damaged bytes
        raise _nothing_in(path) from error
    with np.errstate(over="ignore", invalid="ignore"):  # damaged records hold any number
        columns = _columns(log)
    if not {c.name for c in columns} & {"ATTITUDE", "HIGHRES_IMU", "SERVO_OUTPUT_RAW"}:
        raise _nothing_in(path)
    names = None if wanted is None else set(wanted)
    yield [c for c in columns if names is None or c.name in names]


def _nothing_in(path: Path) -> UnusableInputError:
    return UnusableInputError(
        "no_messages",
        f"{path.name} holds no attitude, sensor or actuator topics of PX4.",
        f"{sentence(mends_of('px4', 'ulog').present(['ATTITUDE', 'RAW_IMU', 'SERVO_OUTPUT_RAW']), '')}, "
        "or give a .tlog.",
    )


def _columns(log: Any) -> list[Columns]:
    topics, said = as_flown(topics_of(log, _READ))
    messages = translate(log, topics, said)
    time_us = np.concatenate([m.time_us for m in messages])
    order = np.empty(len(time_us), dtype=np.int64)
    order[np.argsort(time_us, kind="stable")] = np.arange(len(time_us))
    orders = np.split(order, np.cumsum([len(m.time_us) for m in messages])[:-1])
    base_s = unix_time_base_s(topics)
    system = system_id(log.initial_parameters.get("MAV_SYS_ID"))
    return [
        message(m.name, system, numbers, base_s + m.time_us.astype(np.float64) * 1e-6, m.fields, "ulog")
        for m, numbers in zip(messages, orders, strict=True)
        if len(numbers)
    ]


def translate(log: Any, topics: Topics, chosen: Sequence[str] = ()) -> list[TimedMessages]:
    """Return every message from a `pyulog.ULog` with sentences about the ``chosen`` sensors."""
    parameters = px4_vehicle.parameters_of(log)
    breathed, said = air(topics)
    moved = outputs(topics, parameters)
    messages = [
        *motion(topics, bool(parameters.get("SENS_BOARD_ROT"))),
        *breathed,
        *px4_vehicle.named_values(topics),
        *px4_vehicle.receiver(topics),
        *moved.messages,
        *px4_vehicle.texts(log),
    ]
    start_us = min((int(np.min(m.time_us)) for m in messages), default=0)
    return [
        px4_vehicle.heartbeat(topics, parameters, start_us),
        *px4_vehicle.vtol_states(topics),
        *px4_vehicle.version(log, start_us),
        *px4_vehicle.stated(log, moved.as_parameters, start_us),
        *px4_vehicle.remarks([*chosen, *said, *moved.said, *px4_vehicle.dropouts(log)], start_us),
        *messages,
    ]
