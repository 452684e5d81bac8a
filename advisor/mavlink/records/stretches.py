"""Reading of an ArduPilot log in stretches, so that no log must fit into memory."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.mavlink.records.dataflash import DEFINITION_LAYOUT, RecordTable, layout_of
from advisor.mavlink.records.record_scan import FMT, FMT_LENGTH, Window, bodies, windows
from advisor.process.arrays import IntArray

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
