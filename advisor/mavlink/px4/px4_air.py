"""Air data of a PX4 log: air speed, climb rate and throttle, each at the stamps of its own topic."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.mavlink.px4.px4_topics import (
    TimedMessages,
    Topic,
    Topics,
    best,
    first,
    joined,
    published_us,
    sampled_us,
    samples_of,
)
from advisor.mavlink.records.equivalent import air_data, latest
from advisor.process.arrays import FloatArray, IntArray

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
