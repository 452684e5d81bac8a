"""Files of tables: CSV with any usual separator, and MATLAB's MAT up to version 7."""

import csv
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from advisor.process.arrays import FloatArray
from advisor.words.problems import UnusableInputError

MAT_5 = b"MATLAB 5.0 MAT-file"
"""First bytes of a MAT file that SciPy reads."""
SEPARATORS = ",;\t|"
_FIX = "Export it as CSV with a header line."


def read_table(path: Path) -> Mapping[str, FloatArray]:
    """Return the columns of a table of numbers by name, shape (n,) each; a cell that is no number is NaN.

    Raises
    ------
    UnusableInputError
        The file is no table of numbers.
    """
    try:
        with path.open("rb") as file:
            is_mat = file.read(len(MAT_5)) == MAT_5 or path.suffix.lower() == ".mat"
        columns = _mat(path) if is_mat else _text(path)
    except Exception as error:
        # SciPy passes on its own exceptions, of zlib and of struct, down to Exception itself.
        raise UnusableInputError("table", f"{path.name} is no table of numbers, or damaged.", _FIX) from error
    if not columns:
        raise UnusableInputError("table", f"{path.name} has no column of numbers.", _FIX)
    return columns


def head_of(line: str) -> list[str]:
    """Return the names in the first line of a text table."""
    separator = max(SEPARATORS, key=line.count)
    return [name.strip() for name in next(csv.reader([line.lstrip("#")], delimiter=separator), [])]


def _text(path: Path) -> Mapping[str, FloatArray]:
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
        head = file.readline()
        separator, names = max(SEPARATORS, key=head.count), head_of(head)
        rows = [row for row in csv.reader(file, delimiter=separator) if len(row) >= len(names)]
    values = np.array([[_number(cell) for cell in row[: len(names)]] for row in rows], dtype=np.float64)
    return {name: column for name, column in zip(names, values.T, strict=False) if name}


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return np.nan


def _mat(path: Path) -> Mapping[str, FloatArray]:
    """Return the vectors of a MAT file up to version 7, and those inside its structures as ``name.field``."""
    from scipy.io import loadmat

    columns: dict[str, FloatArray] = {}

    def take(name: str, value: object) -> None:
        if hasattr(value, "_fieldnames"):
            for field in value._fieldnames:
                take(f"{name}.{field}", getattr(value, field))
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim == 1:
            columns[name] = value.astype(np.float64)

    for name, value in loadmat(path, squeeze_me=True, struct_as_record=False).items():
        if not name.startswith("__"):
            take(name, value)
    return columns
