"""Measurements of all manoeuvres of a problem, laid into rows."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple, TypedDict

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.model.axis import Names
from advisor.model.response import Index
from advisor.model.short_period import NAMES

STAMP_S = 1e-9
"""Distance of two stamps below which they are one event, s."""


class Signal(NamedTuple):
    """A quantity over time, linear between its samples."""

    t: FloatArray
    y: FloatArray

    def at(self, t: FloatArray) -> FloatArray:
        """Return values at ``t``; the first and last value beyond the ends."""
        return np.interp(t, self.t, self.y)


@dataclass(frozen=True, slots=True, kw_only=True)
class Laid:
    """Measurements of all manoeuvres as rows, with the parameters that are free."""

    names: Names = NAMES
    z: FloatArray
    """(N,) measurements, manoeuvre by manoeuvre, within one output by output."""
    t: FloatArray
    """(N,) stamps of the measurements."""
    rows: tuple[Mapping[str, slice], ...]
    """For each manoeuvre, output name to its rows."""
    channel: Index
    """(N,) index of the output."""
    owner: Index
    """(N,) index of the manoeuvre."""
    free: Index
    """Indices of the estimated parameters among the shared ones, then the local ones, increasing."""

    @property
    def maneuvers(self) -> int:
        """Number of manoeuvres."""
        return len(self.rows)

    @property
    def common(self) -> Index:
        """Free shared parameters, as indices of all."""
        return self.free[self.free < len(self.names.shared)]

    @property
    def own(self) -> Index:
        """Free parameters of a manoeuvre, as indices of all."""
        return self.free[self.free >= len(self.names.shared)]

    @property
    def blocks(self) -> tuple[slice, ...]:
        """Rows of each manoeuvre."""
        ends = np.searchsorted(self.owner, np.arange(self.maneuvers + 1))
        return tuple(slice(int(a), int(b)) for a, b in pairwise(ends))


class Piece(NamedTuple):
    """One record on the union of its stamps."""

    t: FloatArray
    """(E,) events, s."""
    outputs: Mapping[str, Signal]
    """Measured outputs; each of their stamps is one of ``t``."""
    columns: Mapping[str, FloatArray]
    """Fields of the kernel's grid by their names, (E, ...) each."""


def measured_in(
    outputs: Mapping[str, Signal], order: Sequence[str], delays_s: Mapping[str, float]
) -> dict[str, Signal]:
    """Return the finite samples of the outputs in this order, each at the time of which it tells."""
    found = {name: finite(outputs[name]) for name in order if name in outputs}
    return {name: Signal(signal.t - delays_s.get(name, 0.0), signal.y) for name, signal in found.items()}


def events_of(outputs: Mapping[str, Signal], inputs: Iterable[tuple[FloatArray, float]]) -> FloatArray:
    """Return the events of a record: the stamps of its outputs, and the corners of its inputs among them.

    ``inputs`` are the results of ``Servo.grid``.
    """
    stamps = np.concatenate([signal.t for signal in outputs.values()])
    begin, end, pace = np.min(stamps), np.max(stamps), np.inf
    for breaks, own_pace in inputs:
        stamps = np.concatenate([stamps, breaks[(breaks > begin) & (breaks < end)]])
        pace = min(pace, own_pace)
    return merged(stamps, pace)


def with_samples(outputs: Mapping[str, Signal], needed: Iterable[str]) -> None:
    """Raise ValueError where a needed signal has fewer than two samples."""
    for name in needed:
        if name not in outputs or len(outputs[name].t) < 2:
            raise ValueError(f"a record needs at least two samples of {name}")


def finite(signal: Signal) -> Signal:
    """Return the finite samples of a signal."""
    keep = np.isfinite(signal.y) & np.isfinite(signal.t)
    t, y = (signal.t, signal.y) if keep.all() else (signal.t[keep], signal.y[keep])
    return Signal(np.ascontiguousarray(t, float), np.ascontiguousarray(y, float))


def merged(stamps: FloatArray, pace: float) -> FloatArray:
    """Return the distinct stamps in order, with more between them where their distance exceeds ``pace``."""
    ordered = np.sort(stamps)
    t: FloatArray = ordered[np.concatenate([[True], np.diff(ordered) > STAMP_S])]
    if not np.isfinite(pace):
        return t
    parts: Index = np.maximum(1, np.ceil(np.diff(t) / pace - 1e-6)).astype(np.int64)
    cells = np.repeat(np.arange(len(parts)), parts)
    within = np.arange(len(cells)) - np.repeat(np.cumsum(parts) - parts, parts)
    merged: FloatArray = np.append(t[cells] + within * (np.diff(t) / parts)[cells], t[-1])
    return merged


def padded(rows: FloatArray) -> FloatArray:
    """Return the rows with the last one repeated, so that there are as many steps as events."""
    padded: FloatArray = np.concatenate([rows, rows[-1:]])
    return padded


class Measurements(TypedDict):
    """The fields of ``Laid`` that the measured outputs decide."""

    z: FloatArray
    t: FloatArray
    rows: tuple[Mapping[str, slice], ...]
    channel: Index
    owner: Index


class LaidRows(NamedTuple):
    """Measurements as rows, and where they stand among the events of all records."""

    first: Index
    """(m + 1,) index of the first event of each manoeuvre, and their number."""
    row: Index
    """(C, E) row of the measurement of each output at each event, -1 for none."""
    measurements: Measurements
    columns: Mapping[str, FloatArray]
    """Columns of all records, one after another."""


def nearest_event(events: FloatArray, stamps: FloatArray) -> Index:
    """Return the index of the nearest event of each stamp; ``events`` (E,) are in order, ``stamps`` (n,).

    An event may differ from its stamp by more than ``STAMP_S``, where stamps follow each other more closely.
    """
    index: Index = np.searchsorted((events[1:] + events[:-1]) / 2.0, stamps).astype(np.int64)
    return index


def lay_rows(pieces: Sequence[Piece], outputs: Sequence[str]) -> LaidRows:
    """Lay measurements manoeuvre by manoeuvre, within one output by output; ``outputs`` are the model's."""
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
