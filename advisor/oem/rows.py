"""Measurements of all manoeuvres of a problem, laid into rows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple, Protocol, TypedDict

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


class Stamped(Protocol):
    """One record on the union of its stamps."""

    @property
    def t(self) -> FloatArray:
        """Stamps, s."""

    @property
    def outputs(self) -> Mapping[str, Signal]:
        """Measured outputs; each of their stamps is one of ``t``."""


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


def nearest_event(events: FloatArray, stamps: FloatArray) -> Index:
    """Return the index of the nearest event of each stamp; ``events`` (E,) are in order, ``stamps`` (n,).

    An event may differ from its stamp by more than ``STAMP_S``, where stamps follow each other more closely.
    """
    index: Index = np.searchsorted((events[1:] + events[:-1]) / 2.0, stamps).astype(np.int64)
    return index


def lay_rows(pieces: Sequence[Stamped], outputs: Sequence[str]) -> LaidRows:
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
    return LaidRows(first, row, measurements)
