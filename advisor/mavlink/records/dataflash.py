"""ArduPilot's own log (``.bin``, "dataflash"): self-describing binary records.

A record is two bytes of header, a type, and the fields that the type's FMT record lists (ArduPilot:
AP_Logger, "Log message formats"). Records carry no checksum. So a record counts only when another header, or
the end of the file, follows right behind it.
"""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.messages import FloatArray, IntArray
from advisor.process.compiled import kernel

HEADER = b"\xa3\x95"
_HEADER_0, _HEADER_1 = HEADER
_FMT = 0x80
_FMT_LENGTH = 89
_DEFINITION = HEADER + bytes([_FMT])
_FMT_LAYOUT = np.dtype(
    [("type", "u1"), ("length", "u1"), ("name", "S4"), ("format", "S16"), ("columns", "S64")]
)

# Format character to dtype, and to the divisor of a scaled integer.
_FORMATS: dict[str, tuple[Any, float | None]] = {
    "a": (("<i2", (32,)), None),
    "b": ("i1", None),
    "B": ("u1", None),
    "g": ("<f2", None),
    "h": ("<i2", None),
    "H": ("<u2", None),
    "i": ("<i4", None),
    "I": ("<u4", None),
    "f": ("<f4", None),
    "d": ("<f8", None),
    "n": ("S4", None),
    "N": ("S16", None),
    "Z": ("S64", None),
    "c": ("<i2", 100.0),
    "C": ("<u2", 100.0),
    "e": ("<i4", 100.0),
    "E": ("<u4", 100.0),
    "L": ("<i4", 1e7),
    "M": ("u1", None),
    "q": ("<i8", None),
    "Q": ("<u8", None),
}


@dataclass(frozen=True, slots=True)
class RecordTable:
    """All records of one type, in the order of the file."""

    order: IntArray
    """Shape (n,). Position of each record in the file, bytes."""
    fields: dict[str, NDArray[Any]]
    """Field name to shape (n,), in the units of the log."""

    def __len__(self) -> int:
        return len(self.order)

    @property
    def time_us(self) -> IntArray:
        """Time stamps, shape (n,), microseconds since boot."""
        return np.asarray(self.fields["TimeUS"], dtype=np.int64)

    def first_instance(self) -> "RecordTable":
        """Return the records of the first of several sensors or estimators of one kind."""
        for name in ("I", "C"):
            if name in self.fields:
                return self[self.fields[name] == 0]
        return self

    def __getitem__(self, rows: NDArray[Any]) -> "RecordTable":
        return RecordTable(self.order[rows], {name: values[rows] for name, values in self.fields.items()})


def read_logs(path: Path, names: Iterable[str]) -> Iterator[dict[str, RecordTable]]:
    """Yield the records of the named types, for each log that was joined into the file.

    Two logs may number their types differently. A type without records is left out.
    """
    stream = np.fromfile(path, dtype=np.uint8)
    starts = np.empty(len(stream) // 4 + 1, dtype=np.int64)
    starts = starts[: scan_records(stream, starts)]
    wanted = set(names)
    for log in np.split(starts, _begins(stream, starts)):
        yield _tables(stream, log, wanted)


def _begins(stream: NDArray[np.uint8], starts: IntArray) -> list[int]:
    """Return the rows of ``starts`` at which another log begins: definitions that redefine a type."""
    rows = np.flatnonzero(stream[starts + 2] == _FMT)
    known: dict[int, bytes] = {}
    found: list[int] = []
    run = -1
    for before, row in pairwise([-1, *rows.tolist()]):
        run = run if row == before + 1 else row
        number, at = int(stream[starts[row] + 3]), int(starts[row])
        definition = stream[at : at + _FMT_LENGTH].tobytes()
        if number in known and (number == _FMT or known[number] != definition) and run not in found:
            found.append(run)
            known.clear()
        known[number] = definition
    return found


def _tables(stream: NDArray[np.uint8], starts: IntArray, wanted: set[str]) -> dict[str, RecordTable]:
    """Return the records of one log, which begin at ``starts``."""
    types = stream[starts + 2]
    tables = {}
    definition: Any
    for definition in _records(stream, starts[types == _FMT] + 3, _FMT_LAYOUT):
        name = definition["name"].decode("ascii", "replace")
        layout, divisors = _layout(definition)
        mine = starts[types == definition["type"]]
        if name not in wanted or layout is None or not len(mine):
            continue
        records = _records(stream, mine + 3, layout)
        tables[name] = RecordTable(
            mine,
            {
                field: records[field] if divisor is None else records[field] / divisor
                for field, divisor in zip(layout.names or (), divisors, strict=True)
            },
        )
    return tables


def first_definition(beginning: bytes) -> int:
    """Return the position of the first FMT record that another record follows; -1 for none."""
    at = beginning.find(_DEFINITION)
    while at >= 0 and beginning[at + _FMT_LENGTH : at + _FMT_LENGTH + len(HEADER)] != HEADER:
        at = beginning.find(_DEFINITION, at + 1)
    return at


def gps_time_base_s(gps: RecordTable | None) -> float:
    """Return the time of boot, seconds since 1970, from the first fix with a GPS week; 0 without one."""
    if gps is None:
        return 0.0
    known = np.flatnonzero(gps.fields["GWk"] > 0)
    if not len(known):
        return 0.0
    i = known[0]
    gps_epoch, leap_seconds = 315_964_800, 18
    week, in_week_s = int(gps.fields["GWk"][i]), int(gps.fields["GMS"][i]) / 1000
    return gps_epoch + 604_800 * week + in_week_s - leap_seconds - float(gps.time_us[i]) / 1e6


def _layout(definition: Any) -> tuple["np.dtype[np.void] | None", list[float | None]]:
    """Return the dtype of a type's records, and the divisors of their fields; None for an unreadable
    definition."""
    characters = definition["format"].decode("ascii", "replace")
    names = definition["columns"].decode("ascii", "replace").split(",")
    if (
        len(names) != len(characters)
        or len(set(names)) != len(names)
        or not set(characters) <= _FORMATS.keys()
    ):
        return None, []
    specifications = [_FORMATS[character] for character in characters]
    columns = [
        (name, *kind) if isinstance(kind, tuple) else (name, kind)
        for name, (kind, _) in zip(names, specifications, strict=True)
    ]
    layout = np.dtype(columns)
    if layout.itemsize + 3 != definition["length"]:
        return None, []
    return layout, [divisor for _, divisor in specifications]


def _records(stream: NDArray[np.uint8], bodies: IntArray, layout: "np.dtype[np.void]") -> NDArray[Any]:
    rows = np.empty((len(bodies), layout.itemsize), dtype=np.uint8)
    gather(stream, bodies, rows)
    return np.asarray(rows.view(layout)[:, 0])


@kernel()
def gather(stream: NDArray[np.uint8], bodies: IntArray, rows: NDArray[np.uint8]) -> None:
    """Copy the bytes that begin at each of ``bodies`` into a row of ``rows``."""
    for i in range(len(bodies)):
        rows[i] = stream[bodies[i] : bodies[i] + rows.shape[1]]


@kernel()
def scan_records(stream: NDArray[np.uint8], starts: IntArray) -> int:
    """Find the records: fill ``starts`` and return their number. FMT records give the lengths."""
    n = len(stream)
    lengths = np.zeros(256, dtype=np.int64)
    lengths[_FMT] = _FMT_LENGTH
    count = 0
    at = 0
    while at + 3 <= n:
        if stream[at] == _HEADER_0 and stream[at + 1] == _HEADER_1:
            length = int(lengths[stream[at + 2]])
            end = at + length
            follows = end + 1 < n and stream[end] == _HEADER_0 and stream[end + 1] == _HEADER_1
            if length > 3 and (end == n or follows):
                if stream[at + 2] == _FMT:
                    lengths[stream[at + 3]] = stream[at + 4]
                starts[count] = at
                count += 1
                at = end
                continue
        at += 1
    return count


def seconds(time_us: IntArray) -> FloatArray:
    """Return microseconds as seconds."""
    return time_us.astype(np.float64) * 1e-6
