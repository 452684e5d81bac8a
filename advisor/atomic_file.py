"""Files that are always whole, old or new, even where power fails or the disk is full."""

import os
from pathlib import Path


def write_atomically(path: Path, text: str) -> None:
    """Write a text to a temporary file, then give the file its name.

    Raises
    ------
    OSError
        The file cannot be written. The earlier file is unchanged.
    """
    beside = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        with beside.open("w", encoding="utf-8") as file:
            file.write(text)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
