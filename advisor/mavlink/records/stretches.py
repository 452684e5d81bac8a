"""Reading of an ArduPilot log in stretches, so that no log must fit into memory.

A record is two bytes of header, a type, and the fields that the type's FMT record lists (ArduPilot:
AP_Logger, "Log message formats").
"""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.mavlink.records.record_scan import FMT, FMT_LENGTH, HEADER, Window, bodies, windows
from advisor.process.arrays import FloatArray, IntArray

_DEFINITION = HEADER + bytes([FMT])
DEFINITION_LAYOUT = np.dtype(
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
    """Shape (n,): position of each record in the file, bytes."""
    fields: dict[str, NDArray[Any]]
    """Values of each field, shape (n,), in the units of the log, by the field's name."""

    def __len__(self) -> int:
        return len(self.order)

    @property
    def time_us(self) -> IntArray:
        """Time stamps, shape (n,), microseconds since boot."""
        return np.asarray(self.fields["TimeUS"], dtype=np.int64)

    def __getitem__(self, rows: NDArray[Any]) -> "RecordTable":
        return RecordTable(self.order[rows], {name: values[rows] for name, values in self.fields.items()})


def first_definition(beginning: bytes) -> int:
    """Return the position of the first FMT record that another record follows; -1 for none."""
    at = beginning.find(_DEFINITION)
    while at >= 0 and beginning[at + FMT_LENGTH : at + FMT_LENGTH + len(HEADER)] != HEADER:
        at = beginning.find(_DEFINITION, at + 1)
    return at


def gps_time_base_s(gps: RecordTable | None) -> float:
    """Return the time of boot, seconds since 1970, from the first fix with a GPS week; 0 without one."""
    if gps is None:
        return 0.0
    dated = np.flatnonzero(gps.fields["GWk"] > 0)
    if not len(dated):
        return 0.0
    i = dated[0]
    gps_epoch, leap_seconds = 315_964_800, 18
    week, in_week_s = int(gps.fields["GWk"][i]), int(gps.fields["GMS"][i]) / 1000
    return gps_epoch + 604_800 * week + in_week_s - leap_seconds - float(gps.time_us[i]) / 1e6


def layout_of(definition: Any) -> tuple["np.dtype[np.void] | None", list[float | None]]:
    """Return the dtype of a type's records, and their fields' divisors; None for an unreadable one."""
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


def seconds(time_us: IntArray) -> FloatArray:
    """Return microseconds as seconds."""
    return time_us.astype(np.float64) * 1e-6


def parameters_in(tables: Mapping[str, RecordTable]) -> list[tuple[bytes, float]]:
    """Return names and values of the records PARM, in order of time."""
    if "PARM" not in tables:
        return []
    fields = tables["PARM"].fields
    return list(zip(fields["Name"].tolist(), fields["Value"].tolist(), strict=True))


STRETCH_WINDOWS = 4
"""Length of a stretch in windows, 16 MB of a file. All records of a stretch become messages together, which
need about four times the memory."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """Records of a part of a log, together with some records before and after the part."""

    tables: dict[str, RecordTable]
    begins: float
    """Position in the file at which the part begins, bytes; -inf for the begin of a log."""
    ends: float
    """Position in the file before which the part ends, bytes; inf for the end of a log."""


def read_stretches(
    path: Path,
    names: Iterable[str],
    is_read: Callable[[str], bool] = lambda field: True,
    kept: Collection[str] = (),
    undivided: Collection[str] = (),
    length: float = STRETCH_WINDOWS,
) -> Iterator[Stretch]:
    """Yield the records of the named types, stretch by stretch, for each log in the file.

    Two logs may number their types differently. A type without records is omitted. Memory contains only
    records of the named types, with the fields that ``is_read`` selects.

    Parameters
    ----------
    kept
        Types whose records stay in all later stretches of their log.
    undivided
        Types with which a log is read as one stretch.
    length
        Length of a stretch in windows of the file. One more window before and one after it are included.
    """
    collected = _Collected(frozenset(names), is_read, frozenset(kept))
    before = 0
    for number, window in enumerate(windows(path)):
        yield from collected.take(window)
        if number and number % length == 0 and not collected.holds(undivided):
            yield collected.cut(window.offset, before)
        before = window.offset
    yield from collected.finish()


class _Growing:
    """An array that grows at its end, for which the system moves pages instead of copying."""

    def __init__(self) -> None:
        self._values: NDArray[Any] = np.empty(0)
        self._size = 0

    def extend(self, values: NDArray[Any]) -> None:
        if self._size == 0:
            self._values = np.empty(len(values), values.dtype)
        size = self._size + len(values)
        if size > len(self._values):
            self._values.resize(size + size // 8, refcheck=False)
        self._values[self._size : size] = values
        self._size = size

    def values(self) -> NDArray[Any]:
        """Return all values; nothing can be appended after that."""
        self._values.resize(self._size, refcheck=False)
        return self._values


class _Collected:
    """Records of the wanted message types of one log, until message definitions show that another log begins.

    Definitions come in groups. If a definition redefines a type, its whole group belongs to another log.
    """

    def __init__(self, wanted: frozenset[str], is_read: Callable[[str], bool], kept: frozenset[str]) -> None:
        self._wanted, self._is_read, self._kept = wanted, is_read, kept
        self._known: dict[int, bytes] = {}
        self._run: list[bytes] = []
        self._begin([])

    def _begin(self, definitions: list[bytes]) -> None:
        self._definitions = definitions
        self._rows: dict[tuple[int, np.dtype[np.void]], dict[str, _Growing]] = {}
        self._count = 0
        self._begins = -math.inf

    def take(self, window: Window) -> Iterator[Stretch]:
        """Take the next records, and yield the last stretch of each log that ends there."""
        stream, starts, offset = window
        types = stream[starts + 2]
        done = 0
        for row in [*np.flatnonzero(types == FMT).tolist(), len(starts)]:
            if row > done:
                yield from self._end_run()
                self._gather(stream, starts[done:row], types[done:row], offset)
            if row < len(starts):
                self._run.append(stream[starts[row] + 3 : starts[row] + FMT_LENGTH].tobytes())
            done = row + 1

    def finish(self) -> Iterator[Stretch]:
        yield from self._end_run()
        yield self._last()

    def holds(self, names: Collection[str]) -> bool:
        """Return whether the log has records of any of the given types."""
        return any(
            name in names for number, name, layout, _ in self._defined() if (number, layout) in self._rows
        )

    def cut(self, ends: int, keep_from: int) -> Stretch:
        """Return the stretch before a position in the file, together with all later records so far.

        Records from ``keep_from``, and those of the types to keep, are repeated in the next stretch.
        """
        begins, self._begins = self._begins, ends
        return Stretch(self._tables(keep_from), begins, ends)

    def _last(self) -> Stretch:
        begins, tables = self._begins, self._tables()
        self._begin([])
        return Stretch(tables, begins, math.inf)

    def _end_run(self) -> Iterator[Stretch]:
        """Process a finished group of definitions; yield the last stretch of a log that ends before it."""
        run, self._run = self._run, []
        is_another = False
        for definition in run:
            number = definition[0]
            redefined = number in self._known and (number == FMT or self._known[number] != definition)
            if redefined and not is_another:
                is_another = True
                self._known.clear()
            self._known[number] = definition
        if is_another and self._count:
            yield self._last()
        if is_another:
            self._begin(run)
        else:
            self._definitions += run
        self._layouts = {
            number: layout
            for number, name, layout, _ in self._defined()
            if name in self._wanted and layout is not None
        }

    def _gather(
        self, stream: NDArray[np.uint8], starts: IntArray, types: NDArray[np.uint8], offset: int
    ) -> None:
        self._count += len(starts)
        for number, layout in self._layouts.items():
            mine = starts[types == number]
            if len(mine):
                records = bodies(stream, mine, layout.itemsize).view(layout)[:, 0]
                kept = self._rows.setdefault((number, layout), {})
                kept.setdefault("", _Growing()).extend(mine + offset)
                for name in filter(self._is_read, layout.names or ()):
                    kept.setdefault(name, _Growing()).extend(records[name])

    def _defined(self) -> Iterator[tuple[int, str, "np.dtype[np.void] | None", list[float | None]]]:
        """Yield type, name, layout and divisors of each definition."""
        for definition in np.frombuffer(b"".join(dict.fromkeys(self._definitions)), dtype=DEFINITION_LAYOUT):
            yield (
                int(definition["type"]),
                definition["name"].decode("ascii", "replace"),
                *layout_of(definition),
            )

    def _tables(self, keep_from: float = math.inf) -> dict[str, RecordTable]:
        tables: dict[str, RecordTable] = {}
        for number, name, layout, divisors in self._defined():
            if layout is None or name not in self._wanted:
                continue
            kept = self._rows.pop((number, layout), None)
            if kept is None:
                continue
            stored = {field: growing.values() for field, growing in kept.items()}
            order = stored[""]
            first = 0 if name in self._kept else int(np.searchsorted(order, keep_from))
            if first < len(order):
                self._rows[number, layout] = _grown({f: values[first:] for f, values in stored.items()})
            fields = {}
            for field, divisor in zip(layout.names or (), divisors, strict=True):
                if field in stored:
                    values = stored.pop(field)
                    fields[field] = values if divisor is None else values / divisor
            table = RecordTable(order, fields)
            tables[name] = _merged(tables[name], table) if name in tables else table
        return tables


def _merged(table: RecordTable, other: RecordTable) -> RecordTable:
    """Return the records of two types with one name, in the order of the file, with the fields of both."""
    order = np.concatenate([table.order, other.order])
    rows = np.argsort(order)
    both = [name for name in table.fields if name in other.fields]
    return RecordTable(
        order[rows], {name: np.concatenate([table.fields[name], other.fields[name]])[rows] for name in both}
    )


def _grown(stored: Mapping[str, NDArray[Any]]) -> dict[str, _Growing]:
    """Return longer arrays that begin with copies of the given arrays."""
    grown = {name: _Growing() for name in stored}
    for name, values in stored.items():
        grown[name].extend(values)
    return grown
