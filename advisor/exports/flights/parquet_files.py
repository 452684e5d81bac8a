"""Parquet: one file for each table, with units and meanings in the metadata of each field."""

import json
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from advisor.exports.flights.table import Dataset, FlightTable


def write_parquet(data: Dataset, folder: Path) -> None:
    """Write a dataset as ``TABLE.parquet``, ``record_N/grid.parquet`` and ``record_N/CHANNEL.parquet``.

    The fields' metadata contain ``unit`` and ``about``; the schema's ``advisor`` is a JSON document about the
    logs.
    """
    for table in data.tables:
        _write(table, data, folder / f"{table.name}.parquet")
    for recording in data.recordings:
        (folder / recording.name).mkdir(exist_ok=True)
        for table in (recording.grid, *recording.channels):
            _write(table, data, folder / recording.name / f"{table.name}.parquet")


def _write(table: FlightTable, data: Dataset, path: Path) -> None:
    arrays = [pa.array(column.values) for column in table.columns]
    fields = [
        pa.field(column.name, array.type, metadata={"unit": column.unit, "about": column.about})
        for column, array in zip(table.columns, arrays, strict=True)
    ]
    metadata = {"about": table.about, "advisor": json.dumps(data.about, ensure_ascii=False)}
    with path.open("wb") as file:
        pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields, metadata=metadata)), file)
