"""Measurements of all manoeuvres of a problem, stacked into rows."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypedDict

import numpy as np

from advisor.model.axis import Names
from advisor.model.response import Index
from advisor.model.short_period import NAMES
from advisor.process.arrays import FloatArray

STAMP_S = 1e-9
"""Distance of two stamps below which they are a single event, s."""


class Signal(NamedTuple):
    """A quantity over time, linear between its samples."""

    t: FloatArray
    y: FloatArray

    def at(self, t: FloatArray) -> FloatArray:
        """Return the values at ``t``; beyond the ends, the first or the last value."""
        return np.interp(t, self.t, self.y)

    def after(self, before: "Signal | None") -> "Signal":
        """Return the signal after its samples before a record, if there are any."""
        return self if before is None else Signal(*map(np.append, before, self))


@dataclass(frozen=True, slots=True, kw_only=True)
class Laid:
    """Measurements of all manoeuvres as rows, and the free parameters."""

    names: Names = NAMES
    z: FloatArray
    """Shape (N,): measurements, sorted by manoeuvre and then by output."""
    t: FloatArray
    """Shape (N,): stamps of the measurements, s."""
    rows: tuple[Mapping[str, slice], ...]
    """Rows of each output, by the output's name, in one mapping per manoeuvre."""
    channel: Index
    """Shape (N,): index of each row's output."""
    owner: Index
    """Shape (N,): index of each row's manoeuvre."""
    free: Index
    """Increasing indices of the estimated parameters among the shared, then the local parameters."""

    @property
    def maneuvers(self) -> int:
        """Number of manoeuvres."""
        return len(self.rows)

    @property
    def common(self) -> Index:
        """Indices of the free shared parameters among all parameters."""
        return self.free[self.free < len(self.names.shared)]

    @property
    def own(self) -> Index:
        """Indices of a manoeuvre's free parameters among all parameters."""
        return self.free[self.free >= len(self.names.shared)]

    @property
    def blocks(self) -> tuple[slice, ...]:
        """Rows of each manoeuvre."""
        ends = np.searchsorted(self.owner, np.arange(self.maneuvers + 1))
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))


class Piece(NamedTuple):
    """One record at the union of its stamps."""

    t: FloatArray
    """Shape (E,): times of the events, s."""
    outputs: Mapping[str, Signal]
    """Measured outputs, whose stamps are all in ``t``."""
    columns: Mapping[str, FloatArray]
    """Fields of the kernel's grid by their names, each of shape (E, ...)."""


def measured_in(
    outputs: Mapping[str, Signal], order: Sequence[str], delays_s: Mapping[str, float]
) -> dict[str, Signal]:
    """Return the finite samples of the outputs in ``order``, each at the time of its measurement."""
    measured = {name: finite(outputs[name]) for name in order if name in outputs}
    return {name: Signal(signal.t - delays_s.get(name, 0.0), signal.y) for name, signal in measured.items()}


def events_of(outputs: Mapping[str, Signal], inputs: Iterable[tuple[FloatArray, float]]) -> FloatArray:
    """Return the events of a record: the stamps of its outputs, and the corners of its inputs.

    ``inputs`` are the results of ``Servo.grid``.
    """
    stamps = np.concatenate([signal.t for signal in outputs.values()])
    begin, end, pace = np.min(stamps), np.max(stamps), np.inf
    for breaks, own_pace in inputs:
        stamps = np.concatenate([stamps, breaks[(breaks > begin) & (breaks < end)]])
        pace = min(pace, own_pace)
    return merged(stamps, pace)


def with_samples(outputs: Mapping[str, Signal], needed: Iterable[str]) -> None:
    """Raise ValueError if a needed signal has fewer than two samples."""
    for name in needed:
        if name not in outputs or len(outputs[name].t) < 2:
            raise ValueError(f"a record needs at least two samples of {name}")


def finite(signal: Signal) -> Signal:
    """Return the finite samples of a signal."""
    keep = np.isfinite(signal.y) & np.isfinite(signal.t)
    t, y = (signal.t, signal.y) if keep.all() else (signal.t[keep], signal.y[keep])
    return Signal(np.ascontiguousarray(t, float), np.ascontiguousarray(y, float))


def merged(stamps: FloatArray, pace: float) -> FloatArray:
    """Return the distinct stamps in order, with additional ones where their distance exceeds ``pace``."""
    ordered = np.sort(stamps)
    t: FloatArray = ordered[np.concatenate([[True], np.diff(ordered) > STAMP_S])]
    if not np.isfinite(pace):
        return t
    parts: Index = np.maximum(1, np.ceil(np.diff(t) / pace - 1e-6)).astype(np.int64)
    cells = np.repeat(np.arange(len(parts)), parts)
    within = np.arange(len(cells)) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.append(t[cells] + within * (np.diff(t) / parts)[cells], t[-1])


def padded(rows: FloatArray) -> FloatArray:
    """Return the rows with the last row repeated, for as many steps as events."""
    return np.concatenate([rows, rows[-1:]])


class Measurements(TypedDict):
    """Fields of ``Laid`` that follow from the measured outputs."""

    z: FloatArray
    t: FloatArray
    rows: tuple[Mapping[str, slice], ...]
    channel: Index
    owner: Index


class LaidRows(NamedTuple):
    """Measurements as rows, and their places among the events of all records."""

    first: Index
    """Shape (m + 1,): index of the first event of each manoeuvre, then the number of events."""
    row: Index
    """Shape (C, E): row of each output's measurement at each event, -1 for none."""
    measurements: Measurements
    columns: Mapping[str, FloatArray]
    """Columns of all records, one after another."""


def nearest_event(events: FloatArray, stamps: FloatArray) -> Index:
    """Return the index of the event nearest to each stamp, for ascending ``events`` (E,) and ``stamps`` (n,).

    An event may differ from its stamp by more than ``STAMP_S`` where stamps are closer together.
    """
    return np.searchsorted((events[1:] + events[:-1]) / 2.0, stamps).astype(np.int64)


def lay_rows(pieces: Sequence[Piece], outputs: Sequence[str]) -> LaidRows:
    """Return the measurements sorted by manoeuvre and then by output; ``outputs`` are the model's."""
    first = np.concatenate([[0], np.cumsum([len(piece.t) for piece in pieces])]).astype(np.int64)
    row = np.full((len(outputs), first[-1]), -1, np.int64)
    rows: list[dict[str, slice]] = []
    n = 0
    for m, piece in enumerate(pieces):
        rows.append({})
        for name, signal in piece.outputs.items():
            rows[m][name] = slice(n, n + len(signal.t))
            at = first[m] + nearest_event(piece.t, signal.t)
            row[outputs.index(name), at] = np.arange(n, n + len(signal.t))
            n += len(signal.t)
    signals = [(m, name, signal) for m, p in enumerate(pieces) for name, signal in p.outputs.items()]
    sizes = [len(signal.t) for _, _, signal in signals]
    measurements = Measurements(
        z=np.concatenate([signal.y for _, _, signal in signals]),
        t=np.concatenate([signal.t for _, _, signal in signals]),
        rows=tuple(rows),
        channel=np.repeat([outputs.index(name) for _, name, _ in signals], sizes),
        owner=np.repeat([m for m, _, _ in signals], sizes),
    )
    columns = {name: np.concatenate([p.columns[name] for p in pieces]) for name in pieces[0].columns}
    return LaidRows(first, row, measurements, columns)
