"""Table with named columns: CSV, or MATLAB's MAT up to version 7."""

from collections.abc import Iterator
from pathlib import Path

from advisor.aircraft.aircraft import TableColumns
from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.logs.tables.file import MAT_5, head_of, read_table
from advisor.mavlink.logs.tables.messages import messages_of
from advisor.mavlink.logs.tables.names import plain_name
from advisor.mavlink.logs.tables.quantities import quantities_of
from advisor.words.problems import Problem

_LONGEST_HEAD = 65_536
"""Largest length of a header line, bytes: some thousand names."""
_LEAST_NAMES = 3
"""Least number of columns of a flight: time, rate, surface."""


def _begins_at(beginning: bytes) -> int | None:
    """Return 0 for a MAT file, and for text whose first line is at least three names."""
    if beginning.startswith(MAT_5):
        return 0
    head, newline, _ = beginning[:_LONGEST_HEAD].partition(b"\n")
    if not newline:
        return None
    try:
        line = head.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None
    if not line.strip().replace("\t", " ").isprintable():
        return None
    names = head_of(line.strip())
    named = [name for name in names if any(map(str.isalpha, plain_name(name)))]
    return 0 if len(names) >= _LEAST_NAMES and len(named) == len(names) else None


def _mat_7_3(name: str, beginning: bytes) -> Problem | None:
    if not beginning.startswith((b"MATLAB 7.3 MAT-file", b"\x89HDF\r\n")):
        return None
    text = f"{name} is HDF5, such as a MAT file of version 7.3."
    return Problem("hdf5", text, "In MATLAB save it again with: save('flight.mat', '-v7').")


def _read(path: Path, columns: TableColumns) -> Iterator[list[Columns]]:
    given = quantities_of(read_table(path), columns, path.name)
    yield list(messages_of(given, as_stamped=True))


FORMAT = LogFormat(
    holds="columns of a flight",
    given="a table with named columns (.csv, .mat)",
    ending=".csv",
    begins_at=_begins_at,
    read=lambda path, wanted, starts_at, scanner: _read(path, TableColumns()),
    refusal=_mat_7_3,
    read_columns=_read,
)
