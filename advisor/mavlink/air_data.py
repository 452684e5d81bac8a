"""Air speed and what goes with it in VFR_HUD, from the records of an ArduPilot log."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.messages import FloatArray, IntArray
from advisor.mavlink.dataflash import Table
from advisor.mavlink.equivalent import latest

AIR_RECORDS: dict[str, set[str]] = {
    "ARSP": {"Airspeed"},
    "BARO": {"CRt"},
    "CTUN": set(),
    "EKF1": {"VD"},
    "NKF1": {"VD"},
    "NTUN": {"Arspd"},
    "POS": {"Lat", "Lng", "Alt", "RelHomeAlt"},
    "XKF1": {"VD"},
}
"""Records, and the fields needed of each."""
_AIR_SPEED = {"ARSP": "Airspeed", "CTUN": "As", "NTUN": "Arspd"}
"""Records that hold the air speed, the best first, and the field that does."""
_CLIMB = ("XKF1", "NKF1", "EKF1")
"""Records of the estimators, whose VD is the rate of descent, the newest estimator first."""


@dataclass(frozen=True, slots=True)
class AirData:
    """The fields of VFR_HUD at the stamps of the air speed."""

    order: IntArray
    """Shape (n,). Where the record begins in the file, bytes."""
    time_us: IntArray
    """Shape (n,). Microseconds since boot."""
    fields: Mapping[str, ArrayLike]
    stands_in: str
    """The field that stands in where no sensor was healthy; empty where none does."""


def air_data(tables: Mapping[str, Table], interrupted: bool) -> AirData | None:
    """Air data from the best record that holds the air speed; None without one.

    Parameters
    ----------
    tables
        By name; ARSP of the sensor that flew alone.
    interrupted
        Whether there were stretches without a healthy sensor: the autopilot's own air speed goes on there.
    """
    sources = [
        (tables[name], field)
        for name, field in _AIR_SPEED.items()
        if name in tables and field in tables[name].fields
    ]
    if not sources:
        return None
    (air, field), *spare = sources
    order, time_us, speed = air.order, air.time_us, air.fields[field].astype(np.float64)
    stands_in = ""
    if interrupted and spare:
        other, stands_in = spare[0]
        rows = _away_from(air.time_us, other.time_us)
        order = np.concatenate([order, other.order[rows]])
        time_us = np.concatenate([time_us, other.time_us[rows]])
        speed = np.concatenate([speed, other.fields[stands_in][rows]])
    climb = np.full(len(order), np.nan)
    for record in _CLIMB:
        climb = np.where(np.isnan(climb), -_known(tables, order, record, "VD"), climb)
    fields: dict[str, ArrayLike] = {
        "airspeed": speed,
        "throttle": _known(tables, order, "CTUN", "ThO"),
        "alt": _known(tables, order, "POS", "RelHomeAlt"),
        "climb": np.where(np.isnan(climb), _known(tables, order, "BARO", "CRt"), climb),
    }
    return AirData(order, time_us, fields, stands_in)


def nearest(at_us: IntArray, time_us: IntArray) -> IntArray:
    """Index of the record nearest to each time asked for, the earlier of two."""
    after = np.clip(np.searchsorted(time_us, at_us), 1, max(len(time_us) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time_us) - 1)
    return np.where(at_us - time_us[before] <= time_us[after] - at_us, before, after)


def _known(tables: Mapping[str, Table], at: IntArray, record: str, name: str) -> FloatArray:
    """The newest value of a field in another record at each place, NaN where there is none."""
    table = tables.get(record)
    if table is None or name not in table.fields:
        return np.full(len(at), np.nan)
    table = table.first_instance()
    return latest(at, table.order, table.fields[name])


def _away_from(time_us: IntArray, other_us: IntArray) -> NDArray[np.bool_]:
    """Which of the other times lie further from all times than three of these are apart."""
    if len(time_us) < 2:
        return np.ones(len(other_us), dtype=np.bool_)
    apart_us = np.abs(other_us - time_us[nearest(other_us, time_us)])
    far: NDArray[np.bool_] = apart_us > 3.0 * float(np.median(np.diff(time_us)))
    return far
