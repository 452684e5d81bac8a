"""MATLAB and Octave: one ``flight.mat`` of structs, each with the units of its fields."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from scipy.io import savemat

from advisor.exports.flights.table import Column, Dataset, FlightTable

FILE = "flight.mat"


def write_mat(data: Dataset, folder: Path) -> None:
    """Write a dataset as MAT of version 5: structs of tables, ``record_N.grid``, ``record_N.CHANNEL``,
    ``about``.

    A struct has a vector for each column, and ``units`` and ``meanings`` with equal field names. Texts are
    cells. ``about`` is a JSON document about the logs.
    """
    content: dict[str, Any] = {table.name: _struct(table) for table in data.tables}
    for recording in data.recordings:
        tables = (recording.grid, *recording.channels)
        content[recording.name] = {table.name: _struct(table) for table in tables}
    content["about"] = json.dumps(data.about)
    path = str(folder / FILE)
    savemat(path, content, long_field_names=True, do_compression=True, oned_as="column")


def _struct(table: FlightTable) -> dict[str, Any]:
    return {
        **{column.name: _vector(column) for column in table.columns},
        "units": {column.name: column.unit for column in table.columns},
        "meanings": {column.name: column.about for column in table.columns},
    }


def _vector(column: Column) -> np.ndarray[Any, Any]:
    if column.values.dtype.kind != "U":
        return column.values
    cells = np.empty(len(column.values), dtype=object)
    cells[:] = column.values.tolist()
    return cells
