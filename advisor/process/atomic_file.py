"""Files that are always complete, with old or new content, even after a power failure or on a full disk."""

import os
import secrets
from pathlib import Path

_ONLY_NEW = os.O_WRONLY | os.O_CREAT | os.O_EXCL
# Windows knows no links of this kind, and would translate the ends of lines.
_ONLY_NEW |= getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_BINARY", 0)


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write a file under a temporary name, then rename the file; a text is written in UTF-8.

    The temporary name is random, so that nobody can prepare a link of that name in a shared folder. A link
    with the final name is replaced, and its target does not change.

    Raises
    ------
    OSError
        The file cannot be written. The earlier file is unchanged.
    """
    beside = path.with_name(f".{path.name}.{secrets.token_hex(8)}")
    try:
        with open(os.open(beside, _ONLY_NEW, 0o666), "wb") as file:
            file.write(content.encode() if isinstance(content, str) else content)
            file.flush()
            os.fsync(file.fileno())
        beside.replace(path)
    except OSError:
        beside.unlink(missing_ok=True)
        raise
