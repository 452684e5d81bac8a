"""Fields of a log under the log's own names, without any choice or translation."""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft.aircraft import TableColumns
from advisor.flight.signals.messages import Columns, joined
from advisor.mavlink.logs.kinds import recognised
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.logs.unpack import beginning_of, unpacked
from advisor.mavlink.records.record_scan import FMT, FMT_LENGTH, windows
from advisor.mavlink.records.stretches import DEFINITION_LAYOUT, RecordTable, layout_of, read_stretches
from advisor.mavlink.wire.definitions import DEFINITIONS
from advisor.process.arrays import FloatArray

_INSTANCES = ("I", "IMU")
"""Fields of a dataflash record that contain the number of the sensor."""
_OF_MAVLINK = {"time_boot_ms": 1e-3, "time_usec": 1e-6}
_LATE_S = 5.0
"""Difference from the time of arrival, s, beyond which a stamp belongs to another clock. The delay of a link
is smaller.
"""
_STAMPS = ("TimeUS", "TimeMS", "time_boot_ms", "time_usec")


@dataclass(frozen=True, slots=True)
class RawTable:
    """Numbers of one message of one sensor or sender."""

    t: FloatArray
    """Shape (n,), s since power-on, ascending."""
    fields: Mapping[str, FloatArray]
    """Values of each numeric field, shape (n,), in the log's units."""


def is_dataflash(path: Path) -> bool:
    """Return whether a log, packed or not, contains dataflash records."""
    with unpacked(path, beginning_of(path)) as log:
        kind = recognised(beginning_of(log))
        return kind is not None and kind.format.ending == ".bin"


def read_raw(path: Path, names: Collection[str], columns: TableColumns | None = None) -> dict[str, RawTable]:
    """Return the named messages of a log. A further sensor's name ends in its number: ``IMU[1]``.

    Parameters
    ----------
    path
        Log of any kind.
    names
        Names of messages in the log. PX4's topics have the names of the MAVLink messages that they become.

    columns
        Names of a table's columns; None for usual names.

    Raises
    ------
    UnusableInputError
        The log cannot be read.
    """
    if is_dataflash(path):
        with unpacked(path, beginning_of(path)) as log:
            return _of_records(log, names)
    return _of_messages(path, names, columns)


def _of_records(log: Path, names: Collection[str]) -> dict[str, RawTable]:
    parts: dict[str, list[RecordTable]] = {}
    for stretch in read_stretches(log, names, length=np.inf):
        for name, table in stretch.tables.items():
            parts.setdefault(name, []).append(table)
    raw_tables: dict[str, RawTable] = {}
    for name, tables in parts.items():
        for number, table in _instances(max(tables, key=len)):
            t = _stamp_s(table.fields)
            if t is not None:
                raw_tables[f"{name}[{number}]" if number else name] = _raw(t, table.fields)
    return raw_tables


def _instances(table: RecordTable) -> Iterator[tuple[int, RecordTable]]:
    """Yield the records of each sensor, numbered from 0 in the order of the sensors' numbers."""
    field = next((n for n in _INSTANCES if n in table.fields and _is_numeric(table.fields[n])), None)
    if field is None:
        yield 0, table
        return
    for place, number in enumerate(np.unique(table.fields[field])):
        yield place, table[table.fields[field] == number]


def _of_messages(path: Path, names: Collection[str], columns: TableColumns | None) -> dict[str, RawTable]:
    sent: dict[str, dict[tuple[int, int], list[Columns]]] = {}
    for batch in open_log(path, {*names, "ATTITUDE"} & {*DEFINITIONS}, columns=columns):
        for part in batch:
            sent.setdefault(part.name, {}).setdefault((part.system, part.component), []).append(part)
    # The most talkative sender is the vehicle; others are ground stations and gimbals.
    whole = {
        name: joined(max(senders.values(), key=lambda parts: sum(map(len, parts))))
        for name, senders in sent.items()
    }
    late_s = 0.0
    if "ATTITUDE" in whole:
        attitude = whole["ATTITUDE"]
        late_s = float(np.median(attitude.arrival_s - attitude.fields["time_boot_ms"] * 1e-3))
    elif whole:
        late_s = min(float(part.arrival_s[0]) for part in whole.values())
    return {
        name: _raw(_clock_s(whole[name], late_s), whole[name].fields)
        for name in dict.fromkeys(names)
        if name in whole
    }


def _clock_s(part: Columns, late_s: float) -> FloatArray:
    """Return a message's own stamps, s since power-on. A stamp that does not fit the clock is replaced by the
    time of arrival.
    """
    arrived = part.arrival_s - late_s
    for field, factor in _OF_MAVLINK.items():
        if field in part.fields:
            stamps = np.asarray(part.fields[field], dtype=np.float64) * factor
            if np.max(np.abs(stamps - arrived)) < _LATE_S:
                return stamps
    return arrived


def _stamp_s(fields: Mapping[str, NDArray[Any]]) -> FloatArray | None:
    for name, factor in (("TimeUS", 1e-6), ("TimeMS", 1e-3)):
        if name in fields and _is_numeric(fields[name]):
            return np.asarray(fields[name], dtype=np.float64) * factor
    return None


def _is_numeric(values: NDArray[Any]) -> bool:
    return values.ndim == 1 and values.dtype.kind in "iuf"


def _raw(t: FloatArray, fields: Mapping[str, NDArray[Any]]) -> RawTable:
    order = np.argsort(t, kind="stable")
    numbers = {
        name: np.asarray(values, dtype=np.float64)[order]
        for name, values in fields.items()
        if name not in _STAMPS and _is_numeric(values)
    }
    return RawTable(t[order], numbers)


def names_in(path: Path) -> dict[str, tuple[str, ...]]:
    """Return the fields of each message in a log, by the message's name.

    Raises
    ------
    UnusableInputError
        The log cannot be read.
    """
    if not is_dataflash(path):
        fields: dict[str, tuple[str, ...]] = {}
        for batch in open_log(path):
            fields |= {part.name: tuple(part.fields) for part in batch if part.name not in fields}
        return fields
    defined: dict[str, tuple[str, ...]] = {}
    with unpacked(path, beginning_of(path)) as log:
        for stream, starts, _ in windows(log):
            for at in starts[stream[starts + 2] == FMT].tolist():
                body = stream[at + 3 : at + FMT_LENGTH].tobytes()
                definition = np.frombuffer(body, dtype=DEFINITION_LAYOUT)[0]
                layout, _ = layout_of(definition)
                if layout is not None and layout.names:
                    defined[definition["name"].decode("ascii", "replace")] = layout.names
    return defined
