"""Air data of an ArduPilot log: air speed, climb rate, throttle, each at its own stamps."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.mavlink.ardupilot.sensors import Said
from advisor.mavlink.ardupilot.which_flew import families
from advisor.mavlink.records.dataflash import RecordTable
from advisor.mavlink.records.equivalent import nearest
from advisor.process.arrays import FloatArray, IntArray

_AIR_SPEED = {"ARSP": "Airspeed", "CTUN": "As", "NTUN": "Arspd"}
"""Field with the air speed of each record, the best record first."""


@dataclass(frozen=True, slots=True)
class AirRecords:
    """Air data of a log, and the sentences about their sources."""

    records: list[dict[str, NDArray[Any]]]
    """Order of arrival, stamps in us and values of one field, each of shape (n,)."""
    said: list[Said]


def air(tables: Mapping[str, RecordTable], interrupted: bool) -> AirRecords:
    """Return the air data in the records of a log.

    Parameters
    ----------
    tables
        Records by name. Each holds only the sensor or estimator in use.
    interrupted
        Whether at some times no air speed sensor was healthy.
    """
    speed, said = _airspeed(tables, interrupted)
    descent = _first(tables, [(f"{family}1", "VD") for family in families(tables)])
    climb = _first(tables, [("BARO", "CRt")]) if descent is None else (descent[0], -descent[1])
    by_field = {"climb": climb, "throttle": _first(tables, [("CTUN", "ThO")])}
    others = [
        # The orders of one record are consecutive: CTUN may hold air speed and throttle.
        {"order": series[0].order + place, "time_usec": series[0].time_us, field: series[1]}
        for place, (field, series) in enumerate(by_field.items(), start=2)
        if series is not None
    ]
    return AirRecords([*speed, *others], said)


def _airspeed(
    tables: Mapping[str, RecordTable], interrupted: bool
) -> tuple[list[dict[str, NDArray[Any]]], list[Said]]:
    """Return the air speed from the best record, and from the next record while no sensor was healthy."""
    sources = [
        (tables[name], field)
        for name, field in _AIR_SPEED.items()
        if name in tables and field in tables[name].fields
    ]
    if not sources:
        return [], []
    (best, field), *spare = sources
    order, time_us, speed = best.order, best.time_us, best.fields[field].astype(np.float64)
    said = []
    if interrupted and spare:
        # The autopilot's own air speed goes on without a sensor.
        stand_in, spare_field = spare[0]
        rows = _away_from(time_us, stand_in.time_us)
        if rows.any():
            text = f"Air speed: {spare_field} of the autopilot replaces the sensor while none is healthy"
            said.append(Said(int(stand_in.order[rows][0]), int(stand_in.time_us[rows][0]), text))
        order = np.concatenate([order, stand_in.order[rows]])
        time_us = np.concatenate([time_us, stand_in.time_us[rows]])
        speed = np.concatenate([speed, stand_in.fields[spare_field][rows]])
    return [{"order": order + 1, "time_usec": time_us, "airspeed": speed}], said


def _first(
    tables: Mapping[str, RecordTable], places: Iterable[tuple[str, str]]
) -> tuple[RecordTable, FloatArray] | None:
    """Return the first record that has the named field, with the field's values; None without one."""
    for name, field in places:
        if name in tables and field in tables[name].fields:
            table = tables[name]
            return table, table.fields[field].astype(np.float64)
    return None


def _away_from(time_us: IntArray, other_us: IntArray) -> NDArray[np.bool_]:
    """Return whether each of the other times is more than three sampling intervals away from all
    ``times``.
    """
    if len(time_us) < 2:
        return np.ones(len(other_us), dtype=np.bool_)
    apart_us = np.abs(other_us - time_us[nearest(other_us, time_us)])
    far: NDArray[np.bool_] = apart_us > 3.0 * float(np.median(np.diff(time_us)))
    return far
