"""Formats of an export by name, each imported only when used, and files that appear at once as a set."""

import os
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

from advisor.exports.models.names import NAMES
from advisor.process.parts import FailedPart, attempt
from advisor.words.problems import ConfigurationError


@contextmanager
def staged(folder: Path, inputs: Sequence[Path] = ()) -> Iterator[Path]:
    """Yield a temporary folder. Files written in the block are moved below ``folder`` when the block
    succeeds.

    Existing files of equal name are replaced. After any failure, everything below ``folder`` is unchanged.

    Parameters
    ----------
    folder
        Folder for the files, which is created if missing.

    Raises
    ------
    ConfigurationError
        The folder cannot be created or written to, or a file would replace an input.
    """
    made = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
        stage = Path(tempfile.mkdtemp(prefix=".export-", dir=folder))
    except OSError as error:
        raise _refused(folder, error) from None
    done = False
    try:
        yield stage
        _publish(stage, folder, inputs)
        done = True
    except OSError as error:
        raise _refused(folder, error) from None
    finally:
        shutil.rmtree(stage, ignore_errors=True)
        if not done:
            with suppress(OSError):  # somebody else may have put a file there meanwhile
                for empty in made:
                    empty.rmdir()


def _publish(stage: Path, folder: Path, inputs: Sequence[Path]) -> None:
    """Write all files to the disk, then rename each."""
    files = sorted(path for path in stage.rglob("*") if path.is_file())
    targets = [folder / path.relative_to(stage) for path in files]
    refuse_inputs(targets, inputs)
    for path in files:
        with path.open("rb") as file:
            os.fsync(file.fileno())
    for path, target in zip(files, targets, strict=True):
        target.parent.mkdir(exist_ok=True)
        path.replace(target)


def refuse_inputs(targets: Sequence[Path], inputs: Sequence[Path]) -> None:
    """Refuse to overwrite an input file.

    Raises
    ------
    ConfigurationError
        A target is one of the inputs.
    """
    read = {path.resolve() for path in inputs}
    for target in targets:
        if target.resolve() in read:
            raise ConfigurationError(f"-o: {target} is an input of this command; name another place.")


def _refused(folder: Path, error: OSError) -> ConfigurationError:
    reason = error.strerror or str(error)
    return ConfigurationError(
        f"-o: {folder} cannot be written to: {reason}. Make room or name another place."
    )


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
