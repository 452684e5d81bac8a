"""Files that are old or new and whole, whenever power fails or the disk is full."""

import os
from pathlib import Path


def write_atomically(path: Path, text: str) -> None:
    """Write a text file under a name of its own, then give the file its name.

    Raises
    ------
    OSError
        The file cannot be written; what stood there before is still there.
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
