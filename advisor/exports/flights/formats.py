"""Formats of an export by name, each imported only when used."""

from collections.abc import Sequence
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from advisor.exports.models.names import NAMES
from advisor.process.parts import FailedPart, attempt
from advisor.words.problems import ConfigurationError

if TYPE_CHECKING:
    from advisor.exports.flights.table import Dataset

WRITERS = {
    "csv": ("csv_files", "write_csv"),
    "parquet": ("parquet_files", "write_parquet"),
    "mat": ("mat_file", "write_mat"),
    "mcap": ("mcap_files", "write_mcap"),
}
"""Module and function of each format's writer, by the format's name."""
FORMATS = (*WRITERS, *NAMES)
"""Formats of a flight's data, then those of its model."""
_NEEDS = {"parquet": "pyarrow", "mcap": "mcap"}


def parse_formats(text: str) -> tuple[str, ...]:
    """Read names of formats that commas separate; a repeated name counts once.

    Raises
    ------
    ConfigurationError
        A format is unknown, or its library is not installed.
    """
    formats = tuple(dict.fromkeys(part.strip() for part in text.split(",") if part.strip()))
    unknown = [name for name in formats if name not in FORMATS]
    if unknown or not formats:
        given = f"{unknown[0]} is no format" if unknown else "no format is given"
        raise ConfigurationError(f"--format: {given}; the formats are {', '.join(FORMATS)}.")
    for name in formats:
        if name in _NEEDS and find_spec(_NEEDS[name]) is None:
            raise ConfigurationError(
                f"--format {name} needs {_NEEDS[name]}: pip install 'inflight-advisor[export]'."
            )
    return formats


def write_formats(data: "Dataset", folder: Path, formats: Sequence[str]) -> tuple[FailedPart, ...]:
    """Write a dataset in several formats into a folder; return the formats whose writer failed."""
    failed = []
    for name in formats:
        module, writer = WRITERS[name]
        write = getattr(import_module(f"advisor.exports.flights.{module}"), writer)
        made = attempt(f"export {name}", partial(write, data, folder))
        failed += [made] if isinstance(made, FailedPart) else []
    return tuple(failed)
