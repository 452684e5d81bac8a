"""ArduPilot's own log (``.bin``)."""

import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.flight.signals.messages import Columns, cut
from advisor.mavlink.ardupilot.ardupilot_messages import SELECTORS, Known, Translation
from advisor.mavlink.ardupilot.ardupilot_vehicle import VEHICLE_RECORDS
from advisor.mavlink.ardupilot.body_rates import RATE_RECORDS
from advisor.mavlink.ardupilot.former_records import RENAMED, SENSORS_APART, Clocked, in_todays_names
from advisor.mavlink.ardupilot.log_health import HEALTH_RECORDS, SYSTEM_ID_RECORDS
from advisor.mavlink.ardupilot.sensors import HEALTH_FIELDS
from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.records.record_scan import HEADER
from advisor.mavlink.records.stretches import RecordTable, Stretch, first_definition, read_stretches
from advisor.words.problems import Problem, UnusableInputError

_RECORDS: dict[str, set[str]] = {
    **VEHICLE_RECORDS,
    **RATE_RECORDS,
    **HEALTH_RECORDS,
    **SYSTEM_ID_RECORDS,
    **SELECTORS,
    "ACC": {"AccX", "AccY", "AccZ"},
    "AOA": {"AOA", "SSA"},
    "ARSP": {"Airspeed"},
    "ATT": {"Roll", "Pitch", "Yaw"},
    "BARO": set(),
    "CTUN": set(),
    "EKF1": {"VD"},
    "GPS": {"GWk", "GMS"},
    "IMU": {"GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"},
    "NKF1": {"VD"},
    "NKF2": {"VWN", "VWE"},
    "NTUN": {"Arspd"},
    "NVAL": {"Name", "Value"},
    "NVF": {"Name", "Value"},
    "POS": {"Lat", "Lng", "Alt", "RelHomeAlt"},
    "RCIN": {"C1"},
    "RCOU": {"C1"},
    "RCO2": set(),
    "RCO3": set(),
    "XKF1": {"VD"},
    "XKF2": {"VWN", "VWE"},
}
"""Necessary fields of each record, by the record's name. A record without its necessary fields (another
vehicle, an older version) counts as missing."""
_OF_PX4 = "TIME", "StartTime"
"""Record and field that only PX4's log before 2017 has, in the same container with other units."""
_FIELDS = frozenset[str]().union(*_RECORDS.values(), {_OF_PX4[1]}) | {
    *("TimeUS", "TimeMS", "T", "I", "C"),
    *("As", "BU", "CRt", "Press", "Pri", "ThO", "U"),
    *HEALTH_FIELDS,
    *(former for renamed in RENAMED.values() for former in renamed),
    *(today for renamed in RENAMED.values() for today in renamed.values()),
}
"""Fields that are read: necessary fields, stamps, sensor numbers, and fields of single versions."""
_OF_WHOLE_LOG = (*VEHICLE_RECORDS, *HEALTH_RECORDS, *SYSTEM_ID_RECORDS)
"""Records of a log that later stretches of the log also need. All these records are rare."""
_UNDIVIDED = ("TIME",)
"""Records of logs that are read as one stretch: PX4's, a few minutes long."""
_NUMBERED = re.compile(r"(?:C|Ch|Chan|Out)\d+")
"""Fields of single outputs or channels."""
_TEXTS = {"Name", "Message"}
"""Fields that contain text. All others are numbers."""


def read_dataflash(path: Path, wanted: Iterable[str] | None = None) -> Iterator[list[Columns]]:
    """Yield the messages of a ``.bin``.

    A batch contains a stretch of one of the logs in the file.

    Raises
    ------
    UnusableInputError
        The log contains neither attitude, inertial sensors, nor servo outputs, or it is PX4's of before 2017.
    """
    apart = (name for names in SENSORS_APART.values() for name in names)
    names = None if wanted is None else set(wanted)
    is_log, newest = False, -1
    facts = Known()
    every = (*_RECORDS, _OF_PX4[0], *apart)
    for stretch in read_stretches(path, every, _is_read, _OF_WHOLE_LOG, _UNDIVIDED):
        tables = {name: _believable(stretch.tables.pop(name)) for name in list(stretch.tables)}
        if _OF_PX4[0] in tables and _OF_PX4[1] in tables[_OF_PX4[0]].fields:
            raise UnusableInputError(
                "px4log",
                f"{path.name} is a log of PX4 before 2017, which is not read.",
                "Give a .tlog of the flight, or fly with a firmware that writes a .ulg.",
            )
        messages, facts = _messages(tables, Known() if stretch.begins == -math.inf else facts)
        if messages is not None:
            is_log = True
            for batch in _batch(messages, names, stretch):
                after = [_after(newest, batch, c) for c in batch]
                newest = max(int(c.order[-1]) for c in after)
                yield after
    if not is_log:
        raise UnusableInputError(
            "no_messages",
            f"{path.name} holds no ATT, IMU or RCOU records.",
            "Set LOG_BITMASK so that attitude, IMU and RC output are logged, or give a .tlog.",
        )


def _is_read(field: str) -> bool:
    return field in _FIELDS or _NUMBERED.fullmatch(field) is not None


def _after(newest: int, batch: Sequence[Columns], columns: Columns) -> Columns:
    """Return columns of a batch with orders beyond the newest one of the log before."""
    late_by = newest + 1 - min(int(c.order[0]) for c in batch)
    return replace(columns, order=columns.order + late_by) if newest >= 0 and late_by > 0 else columns


def _messages(stored: Mapping[str, RecordTable], facts: Known) -> tuple[Iterator[Columns] | None, Known]:
    """Return the messages of a stretch, and the facts of its log; no messages without attitude, inertial
    sensors and outputs.
    """
    read = in_todays_names(stored, facts.epoch_s)
    tables = {
        name: table
        for name, table in read.tables.items()
        if name in _RECORDS and _RECORDS[name] <= table.fields.keys()
    }
    if not tables.keys() & {"ATT", "IMU", "RCOU"}:
        return None, facts
    translation = Translation(Clocked(tables, read.epoch_s), facts)
    return translation.columns(), translation.facts


def _believable(table: RecordTable) -> RecordTable:
    """Return the fields whose value types fit their names. A damaged definition can have other types."""
    fields = {
        name: values
        for name, values in table.fields.items()
        if values.ndim == 1 and (values.dtype.kind == "S") == (name in _TEXTS)
    }
    return RecordTable(table.order, fields)


def _batch(columns: Iterator[Columns], names: set[str] | None, part: Stretch) -> Iterator[list[Columns]]:
    """Yield all wanted messages of a part of a log in one batch; nothing without messages."""
    with np.errstate(over="ignore", invalid="ignore"):  # damaged records hold any number
        wanted = [_within(part, c) for c in columns if names is None or c.name in names]
    if batch := [c for c in wanted if len(c)]:
        yield batch


def _within(part: Stretch, columns: Columns) -> Columns:
    inside = (columns.order >= part.begins) & (columns.order < part.ends)
    return columns if inside.all() else cut(columns, inside)


_TEXT_LOG = re.compile(rb"^FMT, ?\d+, ?\d+, ?\w+, ?\w+, ?\w+", re.MULTILINE)
"""Pattern of a record definition as text. Ground stations write a few lines about the vehicle before the
first."""


def _begins_at(beginning: bytes) -> int | None:
    at = 0 if beginning.startswith(HEADER) else first_definition(beginning)
    return at if at >= 0 else None


def _text_log(name: str, beginning: bytes) -> Problem | None:
    if not _TEXT_LOG.search(beginning):
        return None
    text = f"{name} is a DataFlash log written as text."
    return Problem("text_log", text, "Give the .bin that it was made from.")


FORMAT = LogFormat(
    holds="DataFlash records",
    given="an ArduPilot .bin",
    ending=".bin",
    begins_at=_begins_at,
    read=lambda path, wanted, starts_at, scanner: read_dataflash(path, wanted),
    refusal=_text_log,
)
