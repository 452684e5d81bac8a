"""Quantities of a table in SI units, from the columns that the aircraft file names, then from columns with
usual names.
"""

from collections.abc import Mapping
from dataclasses import fields

import numpy as np

from advisor.aircraft.aircraft import TableColumns
from advisor.mavlink.logs.tables.names import ANGLES, RATES, is_flight, recognised_columns, unit_of
from advisor.process.arrays import FloatArray
from advisor.words.problems import ConfigurationError, UnusableInputError

_HALF_TURN = ("elevator", "aileron", "rudder", "alpha", "beta", "theta")
"""Angles that never exceed a quarter of a turn, so that larger values cannot be in rad."""
_SHOWN = 20
"""Largest number of a table's columns that a sentence lists."""


def quantities_of(
    table: Mapping[str, FloatArray], columns: TableColumns, file: str
) -> Mapping[str, FloatArray]:
    """Return the quantities of a table in SI units by their keys in the section ``columns``, shape (n,) each.

    A name of the aircraft file counts before a usual name. The unit at the end of a column's name counts
    before ``units``, unless ``scale`` has the quantity.

    Raises
    ------
    ConfigurationError
        The aircraft file names a column that the table lacks.
    UnusableInputError
        Time, rate or surface is missing, the time does not rise, or an angle cannot be in rad.
    """
    table = _one_group(table)
    named = {f.name: getattr(columns, f.name) for f in fields(columns) if f.name not in ("units", "scale")}
    lost = [(key, column) for key, column in named.items() if column is not None and column not in table]
    if lost:
        key, column = lost[0]
        raise ConfigurationError(f"columns.{key}: {file} has no column {column!r}; it has {_listed(table)}.")
    others = [column for column in table if column not in named.values()]
    usual = {key: recognised.column for key, recognised in recognised_columns(others).items()}
    chosen = {key: named.get(key) or usual.get(key) for key in {**named, **usual}}
    quantities = {
        key: _factor(key, column, columns) * table[column]
        for key, column in chosen.items()
        if column is not None and len(table[column]) == len(table[chosen["time"] or column])
    }
    _refuse_missing(quantities, table, file)
    _refuse_degrees(quantities, chosen, file)
    return quantities


def _one_group(table: Mapping[str, FloatArray]) -> Mapping[str, FloatArray]:
    """Return the columns of the only structure of a MAT file that holds a flight; all columns if there is no
    such structure.
    """
    groups: dict[str, dict[str, FloatArray]] = {}
    for name, column in table.items():
        groups.setdefault(name.rpartition(".")[0], {})[name] = column
    flights = [group for group in groups.values() if is_flight(group)]
    return max(flights, key=len) if flights and len(groups) > 1 else table


def _factor(key: str, column: str, columns: TableColumns) -> float:
    is_angle = key in ANGLES or key in RATES
    stated = float(np.radians(1.0)) if is_angle and columns.units == "deg" else 1.0
    if key in columns.scale:
        return columns.scale[key] * stated
    usual = recognised_columns([column]).get(key)
    by_name = unit_of(key, column) if usual is None else usual.factor
    return stated if by_name is None else by_name


def _refuse_missing(values: Mapping[str, FloatArray], table: Mapping[str, FloatArray], file: str) -> None:
    missing = [key for key in ("time",) if key not in values]
    missing += [] if values.keys() & RATES else ["q (or p, r)"]
    missing += [] if values.keys() & {"elevator", "aileron", "rudder"} else ["elevator (or aileron, rudder)"]
    if missing:
        raise UnusableInputError(
            "table_columns",
            f"{file} has no column that is {' and '.join(missing)}; it has {_listed(table)}.",
            "Name its columns in the aircraft file: columns: {time: …, elevator: …, q: …}.",
        )
    t = values["time"]
    if len(t) < 2 or not np.all(np.diff(t) > 0.0):
        raise UnusableInputError(
            "table_time", f"The time of {file} does not rise from row to row.", "Correct columns.time."
        )


def _refuse_degrees(values: Mapping[str, FloatArray], chosen: Mapping[str, str | None], file: str) -> None:
    """Refuse angles whose values are not in rad."""
    for name in (n for n in _HALF_TURN if n in values):
        largest = float(np.nanmax(np.abs(values[name]), initial=0.0))
        if largest > np.pi / 2.0:
            raise UnusableInputError(
                "table_units",
                f"{file}: {chosen[name]} reaches {largest:.3g}; {name} in rad is below 1.57.",
                "Write columns: {units: deg} in the aircraft file where the table is in degrees.",
            )


def _listed(table: Mapping[str, FloatArray]) -> str:
    names = [*list(table)[:_SHOWN], *(["…"] if len(table) > _SHOWN else [])]
    return ", ".join(names)
