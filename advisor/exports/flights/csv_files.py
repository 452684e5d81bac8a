"""CSV: one file for each table with a header line of names; ``columns.json`` has the units."""

import csv
import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from advisor.exports.flights.table import Column, Dataset, FlightTable

SIDECAR = "columns.json"


def write_csv(data: Dataset, folder: Path) -> None:
    """Write a dataset as ``TABLE.csv``, ``record_N/grid.csv`` and ``record_N/CHANNEL.csv``.

    Numbers have enough digits to restore the float64 value. A missing value is an empty field.
    """
    files = {f"{table.name}.csv": table for table in data.tables}
    for recording in data.recordings:
        (folder / recording.name).mkdir(exist_ok=True)
        files |= {f"{recording.name}/{t.name}.csv": t for t in (recording.grid, *recording.channels)}
    for name, table in files.items():
        with (folder / name).open("w", encoding="utf-8", newline="") as file:
            rows = csv.writer(file)
            rows.writerow([column.name for column in table.columns])
            rows.writerows(zip(*map(_shown, table.columns), strict=True))
    sidecar = {**data.about, "files": {name: _described(table) for name, table in files.items()}}
    text = json.dumps(sidecar, ensure_ascii=False, indent=1)
    (folder / SIDECAR).write_text(text, encoding="utf-8")


def _shown(column: Column) -> Iterator[object]:
    values = column.values.tolist()
    if column.values.dtype.kind != "f":
        return iter(values)
    return (repr(value) if np.isfinite(value) else "" for value in values)


def _described(table: FlightTable) -> dict[str, object]:
    columns = {c.name: {"unit": c.unit, "about": c.about} for c in table.columns}
    return {"about": table.about, "columns": columns}
