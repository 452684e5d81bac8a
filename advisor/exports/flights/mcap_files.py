"""MCAP: one file for each power-on, JSON messages with JSON schemas, log times from the vehicle's clock."""

import json
from collections.abc import Iterator
from heapq import merge
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import Writer

from advisor import __version__
from advisor.exports.flights.table import Column, Dataset, FlightTable, Recording

_TYPES = {"f": "number", "i": "integer", "b": "boolean", "U": "string"}
_TIMES = {"maneuvers": "end_boot_s"}
"""Column with the message times of each table without ``t_boot_s``."""


def write_mcap(data: Dataset, folder: Path) -> None:
    """Write a dataset as ``record_N.mcap``: a topic for each channel, ``/maneuvers``, ``/residuals_OUTPUT``.

    The time of a message is the vehicle's time since boot, in ns. The estimates follow at the end of the last
    record, one message for each parameter. The schemas contain units and meanings. Unknown numbers are null.
    """
    for number, recording in enumerate(data.recordings, start=1):
        results = [t for t in data.tables if t.name not in ("channels", "estimates")]
        tables = [*recording.channels, *(_of_record(t, number) for t in results)]
        estimates = [data.table("estimates")] if number == len(data.recordings) else []
        with (folder / f"{recording.name}.mcap").open("wb") as file:
            _write(file, data, [t for t in tables if len(t)], estimates, _end_s(recording))


def _write(
    file: Any, data: Dataset, tables: list[FlightTable], at_end: list[FlightTable], end_s: float
) -> None:
    writer = Writer(file)
    writer.start(profile="", library=f"inflight-advisor {__version__}")
    writer.add_metadata("advisor", {"about": json.dumps(data.about, ensure_ascii=False)})
    streams = [_messages(t, _register(writer, t), t[_TIMES.get(t.name, "t_boot_s")]) for t in tables]
    ends = [_messages(t, _register(writer, t), np.full(len(t), end_s)) for t in at_end]
    for sequence, (at_ns, topic, message) in enumerate(merge(*streams, *ends, key=lambda entry: entry[0])):
        text = json.dumps(message, ensure_ascii=False, allow_nan=False).encode()
        writer.add_message(topic, log_time=at_ns, publish_time=at_ns, sequence=sequence, data=text)
    writer.finish()  # type: ignore[no-untyped-call]


def _register(writer: Writer, table: FlightTable) -> int:
    schema = {
        "title": table.name,
        "description": table.about,
        "type": "object",
        "properties": {column.name: _property(column) for column in table.columns},
    }
    text = json.dumps(schema, ensure_ascii=False).encode()
    schema_id = writer.register_schema(f"advisor.{table.name}", "jsonschema", text)
    return writer.register_channel(f"/{table.name}", "json", schema_id)


def _property(column: Column) -> dict[str, Any]:
    kind = _TYPES[column.values.dtype.kind]
    return {
        "type": ["number", "null"] if kind == "number" else kind,
        "description": f"{column.about} [{column.unit}]" if column.unit else column.about,
        "unit": column.unit,
    }


def _messages(
    table: FlightTable, topic: int, at_s: np.ndarray[Any, Any]
) -> Iterator[tuple[int, int, dict[str, Any]]]:
    names = [column.name for column in table.columns]
    rows = zip(*(column.values.tolist() for column in table.columns), strict=True)
    for at_ns, row in zip(np.round(at_s * 1e9).astype(np.int64).tolist(), rows, strict=True):
        yield at_ns, topic, {name: _known(value) for name, value in zip(names, row, strict=True)}


def _known(value: Any) -> Any:
    return None if isinstance(value, float) and not np.isfinite(value) else value


def _of_record(table: FlightTable, number: int) -> FlightTable:
    rows = np.flatnonzero(table["record"] == number)
    rows = rows[np.argsort(table[_TIMES.get(table.name, "t_boot_s")][rows], kind="stable")]
    columns = tuple(Column(c.name, c.values[rows], c.unit, c.about) for c in table.columns)
    return FlightTable(table.name, table.about, columns)


def _end_s(recording: Recording) -> float:
    return max(float(table["t_boot_s"][-1]) for table in recording.channels)
