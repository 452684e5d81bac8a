"""Records of every firmware since 2013 under present names, each with its time since boot.

Firmware of 2013 to 2015 stamped records in milliseconds and numbered channels ``Chan1`` or ``Ch1``. A second
sensor had a separate record, and some records had no time (ArduPilot, DataFlash.h and ArduPlane/Log.cpp).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from advisor.mavlink.records.stretches import RecordTable
from advisor.process.arrays import IntArray

SENSORS_APART = {
    "IMU": ("IMU2", "IMU3"),
    "ARSP": ("ASP2",),
    "BARO": ("BAR2", "BAR3"),
    "GPS": ("GPS2",),
    "XKF1": ("XKF6",),
    "XKF2": ("XKF7",),
    "NKF1": ("NKF6",),
    "NKF2": ("NKF7",),
    "GYR": ("GYR1", "GYR2", "GYR3"),
    "ACC": ("ACC1", "ACC2", "ACC3"),
}
"""Former records of further sensors and lanes, by the present record with a sensor number in field I."""
RENAMED = {
    "CTUN": {"ThrOut": "ThO"},
    "GPS": {"Week": "GWk", "TimeMS": "GMS"},
    "IMU": {"GyHlt": "GH", "AcHlt": "AH"},
}
"""Present name of each former field, by the record's name."""
_CHANNEL = re.compile(r"(?:Chan|Ch)(\d+)")
_1970_US = 10**15
"""Least stamp, us, that is relative to 1970 instead of boot: 31 years."""


@dataclass(frozen=True, slots=True)
class Clocked:
    """Records of a log on one clock."""

    tables: Mapping[str, RecordTable]
    """Tables of records by their present names. Every table has TimeUS, int64."""
    epoch_s: int
    """Seconds since 1970 at TimeUS 0 for stamps relative to 1970; 0 for stamps since boot."""


def in_todays_names(tables: Mapping[str, RecordTable], epoch_s: int | None = None) -> Clocked:
    """Return all records of a log, renamed, on one clock, with several records of one kind of sensor joined.

    ``epoch_s`` comes from an earlier stretch of the log; None to determine it from these records.
    """
    named = {name: _renamed(name, table) for name, table in tables.items()}
    timed = _timed(named)
    if epoch_s is None:
        epoch_s = _epoch_s(timed)
    if epoch_s:
        timed = {name: _at(table, table.time_us - 1_000_000 * epoch_s) for name, table in timed.items()}
    return Clocked(_joined(timed), epoch_s)


def _epoch_s(timed: Mapping[str, RecordTable]) -> int:
    """Return the time in seconds since 1970 of the first stamp relative to 1970; 0 for stamps since boot."""
    stamps = np.concatenate([table.time_us for table in timed.values()]) if timed else np.zeros(0, np.int64)
    if len(stamps) == 0 or not np.median(stamps) > _1970_US:
        return 0
    return int(np.min(stamps[stamps > _1970_US])) // 1_000_000


def _renamed(name: str, table: RecordTable) -> RecordTable:
    """Return the fields under present names, with TimeUS if the record has a time since boot."""
    fields = dict(table.fields)
    name = next((main for main, apart in SENSORS_APART.items() if name in apart), name)
    if "TimeUS" in fields:
        fields["TimeUS"] = fields["TimeUS"].astype(np.int64)
    else:
        # TimeMS of GPS is the time of the week, and T the time since boot.
        stated = "T" if name == "GPS" else "TimeMS"
        if stated in fields:
            fields["TimeUS"] = 1000 * fields[stated].astype(np.int64)
    renamed = RENAMED.get(name, {})
    channels = name in ("RCOU", "RCIN")
    present = {}
    for field, values in fields.items():
        numbered = _CHANNEL.fullmatch(field) if channels else None
        present[f"C{numbered[1]}" if numbered else renamed.get(field, field)] = values
    return replace(table, fields=present)


def _timed(tables: Mapping[str, RecordTable]) -> dict[str, RecordTable]:
    """Return tables with a time for each record, by default that of the stamped record before it."""
    stamped = [table for table in tables.values() if "TimeUS" in table.fields]
    if not stamped or len(stamped) == len(tables):
        return {**tables} if stamped else {}
    order = np.concatenate([table.order for table in stamped])
    time_us = np.concatenate([table.time_us for table in stamped])
    rows = np.argsort(order)
    order, time_us = order[rows], time_us[rows]
    timed = {}
    for name, table in tables.items():
        if "TimeUS" not in table.fields:
            before = np.searchsorted(order, table.order, side="right") - 1
            table = _at(table, time_us[np.maximum(before, 0)])
        timed[name] = table
    return timed


def _at(table: RecordTable, time_us: IntArray) -> RecordTable:
    return replace(table, fields={**table.fields, "TimeUS": np.maximum(time_us, 0)})


def _joined(tables: Mapping[str, RecordTable]) -> dict[str, RecordTable]:
    """Return the tables with former records of further sensors merged, numbered in field I."""
    joined = dict(tables)
    for name, apart in SENSORS_APART.items():
        further = [joined.pop(other) for other in apart if other in joined]
        if not further:
            continue
        sensors = ([joined[name]] if name in joined else []) + further
        shared = set.intersection(*(set(table.fields) for table in sensors)) - {"I"}
        numbers = [np.full(len(table), number, np.int64) for number, table in enumerate(sensors)]
        order = np.concatenate([table.order for table in sensors])
        rows = np.argsort(order)
        fields = {f: np.concatenate([table.fields[f] for table in sensors])[rows] for f in shared}
        joined[name] = RecordTable(order[rows], {**fields, "I": np.concatenate(numbers)[rows]})
    return joined
