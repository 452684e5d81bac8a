"""ArduPilot's own log (``.bin``, "dataflash"): self-describing binary records.

A record is two bytes of header, a type, and the fields that the type's FMT record lists (ArduPilot:
AP_Logger, "Log message formats").
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.flight.signals.messages import FloatArray, IntArray
from advisor.mavlink.records.record_scan import FMT, FMT_LENGTH, HEADER, Window, bodies, windows

_DEFINITION = HEADER + bytes([FMT])
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


def read_logs(
    path: Path, names: Iterable[str], is_read: Callable[[str], bool] = lambda field: True
) -> Iterator[dict[str, RecordTable]]:
    """Yield the records of the named types, for each log that was joined into the file.

    Two logs may number their types differently. A type without records is left out. Only records of the named
    types are kept in memory, of these only the fields that ``is_read`` names.
    """
    collected = _Collected(frozenset(names), is_read)
    for window in windows(path):
        yield from collected.take(window)
    yield from collected.finish()


class _Growing:
    """An array that grows at its end, where the system moves its pages instead of copying them."""

    def __init__(self) -> None:
        self._values: NDArray[Any] = np.empty(0)
        self._size = 0

    def extend(self, values: NDArray[Any]) -> None:
        """Append values of one type."""
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
    """Records of the wanted types of one log, until definitions show that another log begins.

    Definitions stand in runs. One that redefines a type is the first of another log, together with the rest
    of its run.
    """

    def __init__(self, wanted: frozenset[str], is_read: Callable[[str], bool]) -> None:
        self._wanted, self._is_read = wanted, is_read
        self._known: dict[int, bytes] = {}
        self._run: list[bytes] = []
        self._begin([])

    def _begin(self, definitions: list[bytes]) -> None:
        self._definitions = definitions
        self._rows: dict[tuple[int, np.dtype[np.void]], dict[str, _Growing]] = {}
        self._count = 0

    def take(self, window: Window) -> Iterator[dict[str, RecordTable]]:
        """Take the next records; yield each log that ends among them."""
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

    def finish(self) -> Iterator[dict[str, RecordTable]]:
        """Yield the last log."""
        yield from self._end_run()
        yield self._tables()

    def _end_run(self) -> Iterator[dict[str, RecordTable]]:
        """Take the definitions of a run that is over; yield the log that ends before them, if one does."""
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
            yield self._tables()
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
        for definition in np.frombuffer(b"".join(dict.fromkeys(self._definitions)), dtype=_FMT_LAYOUT):
            yield int(definition["type"]), definition["name"].decode("ascii", "replace"), *_layout(definition)

    def _tables(self) -> dict[str, RecordTable]:
        """Return the collected records, and keep none of them."""
        tables = {}
        for number, name, layout, divisors in self._defined():
            if layout is None or name not in self._wanted:
                continue
            kept = self._rows.pop((number, layout), None)
            if kept is None:
                continue
            order, fields = kept.pop("").values(), {}
            for field, divisor in zip(layout.names or (), divisors, strict=True):
                if field in kept:
                    values = kept.pop(field).values()
                    fields[field] = values if divisor is None else values / divisor
            tables[name] = RecordTable(order, fields)
        self._begin([])
        return tables


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


def seconds(time_us: IntArray) -> FloatArray:
    """Return microseconds as seconds."""
    return time_us.astype(np.float64) * 1e-6
