"""Tables with names, units and meanings, from which every export format is written."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Column:
    """One column of a table."""

    name: str
    """Name of letters, digits and underscores that begins with a letter."""
    values: NDArray[Any]
    """Shape (n,): float64 with NaN for unknown values, int64, bool, or text (NumPy kind ``U``)."""
    unit: str
    """SI unit, such as ``rad/s``; ``1`` for a pure number; empty without a quantity."""
    about: str
    """Meaning of the column in one sentence."""


@dataclass(frozen=True, slots=True)
class FlightTable:
    """Columns of equal length."""

    name: str
    """Name of the file or variable, without an ending."""
    about: str
    """Meaning of a table row in one sentence."""
    columns: tuple[Column, ...]

    def __len__(self) -> int:
        return len(self.columns[0].values)

    def __getitem__(self, name: str) -> NDArray[Any]:
        """Return the values of a column by name, shape (n,)."""
        return next(column.values for column in self.columns if column.name == name)


@dataclass(frozen=True, slots=True)
class Recording:
    """One power-on of the vehicle in one log, with all times on one clock."""

    name: str
    """Name of the record, ``record_1``, ``record_2``, ... in the order of flying."""
    channels: tuple[FlightTable, ...]
    """A table for each channel, at its own stamps: ``t_boot_s`` and a column with the channel's name."""
    grid: FlightTable
    """Table of all channels at common times: ``t_boot_s`` and a column for each channel."""


@dataclass(frozen=True, slots=True)
class Dataset:
    """All tables of an export."""

    recordings: tuple[Recording, ...]
    tables: tuple[FlightTable, ...]
    """Tables of results: ``channels``, ``maneuvers``, ``estimates``, ``residuals_OUTPUT``."""
    about: Mapping[str, Any] = field(default_factory=dict)
    """Origin of the data for JSON: version, logs with their SHA-256, grid, notes."""

    def table(self, name: str) -> FlightTable:
        """Return one of ``tables`` by name."""
        return next(table for table in self.tables if table.name == name)


def texts(values: Sequence[str]) -> NDArray[np.str_]:
    """Return texts as a column's values, shape (n,)."""
    return np.array(list(values), dtype=np.str_)


def counts(values: Sequence[int]) -> NDArray[np.int64]:
    """Return whole numbers as a column's values, shape (n,)."""
    return np.array(list(values), dtype=np.int64)


def truths(values: Sequence[bool]) -> NDArray[np.bool_]:
    """Return truth values as the values of a table's column, shape (n,)."""
    return np.array(list(values), dtype=np.bool_)


def numbers(values: Sequence[float | None]) -> NDArray[np.float64]:
    """Return numbers as the values of a table's column, shape (n,), with NaN for None."""
    return np.array([np.nan if value is None else value for value in values], dtype=np.float64)
