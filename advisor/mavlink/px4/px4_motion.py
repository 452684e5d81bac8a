"""Motion data of a PX4 log: attitude, rates, specific force and height."""

from collections.abc import Iterator

import numpy as np
from numpy.typing import ArrayLike

from advisor.flight.signals.attitude import euler_angles
from advisor.mavlink.px4.px4_topics import (
    TimedMessages,
    Topics,
    best,
    first,
    milliseconds,
    published_us,
    sampled_us,
    vector,
)
from advisor.mavlink.records.equivalent import side_by_side

_RATES = ("rollspeed", "pitchspeed", "yawspeed")


def motion(topics: Topics, is_turned: bool = False) -> Iterator[TimedMessages]:
    """Yield attitude, specific force, static pressure and height, where the log has their values.

    Parameters
    ----------
    is_turned
        Whether the board is mounted turned, so that the axes of a raw sensor are not the body's.
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
    """Yield angles at the stamps of the attitude, rates at those of the angular velocity or of the gyro."""
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
