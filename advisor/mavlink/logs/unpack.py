"""Access to a log's file. An unreadable file is refused, and a packed file (gzip, zip) is unpacked."""

import gzip
import stat
import tempfile
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from advisor.mavlink.logs.kinds import BEGINNING_BYTES, recognised, refusal
from advisor.words.problems import UnusableInputError

LARGEST_UNPACKED_BYTES = (1 << 32) - 1
"""Largest log that is unpacked, bytes. Autopilots write to FAT32 cards, on which no file is larger."""
MOST_TIMES = 100
"""Largest ratio of a log's size to the size of its packed file. Packing shrinks this project's logs to
between a half and a tenth, and the log of a standing vehicle to a fiftieth.
"""
_SMALL_BYTES = 64_000_000
"""Size of a log up to which any ratio is accepted, bytes."""
_MOST_MEMBERS = 1000
"""Largest number of an archive's files that are examined."""
_NAMED = 5
"""Largest number of an archive's logs that a sentence names."""
_GZIP, _ZIP = b"\x1f\x8b", b"PK\x03\x04"
_OTHER_FILES = {
    stat.S_ISDIR: ("not_a_file", "is a folder", "Give the log file inside it."),
    stat.S_ISFIFO: ("not_a_file", "is a pipe", "Write the pipe's bytes to a file and give that file."),
    stat.S_ISCHR: ("not_a_file", "is a device", "For a live link use: advisor live --master."),
    stat.S_ISBLK: ("not_a_file", "is a device", "Give the log file on the device."),
    stat.S_ISSOCK: ("not_a_file", "is a socket", "For a live link use: advisor live --master."),
}


def beginning_of(path: Path) -> bytes:
    """Return the first ``BEGINNING_BYTES`` of a file.

    Raises
    ------
    UnusableInputError
        The file is missing, is no regular file, or may not be read.
    """
    try:
        mode = path.stat().st_mode
        for is_this, (code, what, fix) in _OTHER_FILES.items():
            if is_this(mode):
                raise UnusableInputError(code, f"{path} {what}, not a file.", fix)
        with path.open("rb") as file:
            return file.read(BEGINNING_BYTES)
    except FileNotFoundError:
        raise UnusableInputError(
            "no_such_file", f"There is no file {path}.", "Check the name and the folder."
        ) from None
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise UnusableInputError(
            "unreadable", f"{path} cannot be read: {reason}.", "Check its name and its permissions."
        ) from None


@contextmanager
def unpacked(path: Path, beginning: bytes) -> Iterator[Path]:
    """Yield the file itself, or the log inside a packed file, for the duration of the context.

    Parameters
    ----------
    beginning
        Result of :func:`beginning_of`.

    Raises
    ------
    UnusableInputError
        An archive is damaged or encrypted, contains no or several logs, or a log beyond
        ``LARGEST_UNPACKED_BYTES`` or ``MOST_TIMES``.
    """
    if not beginning.startswith((_GZIP, _ZIP)):
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="advisor-") as folder:
        try:
            size = path.stat().st_size
            if beginning.startswith(_GZIP):
                with gzip.open(path) as packed:
                    log = _copy(packed, path.name, size, Path(folder) / (path.stem or path.name))
            else:
                with zipfile.ZipFile(path) as archive:
                    member = _only_log(archive, path.name)
                    with archive.open(member) as packed:
                        log = _copy(packed, path.name, size, Path(folder) / Path(_shown(member)).name)
        except OSError as error:
            if error.strerror is None:
                raise _damaged(path) from None
            raise UnusableInputError(
                "packed",
                f"{path.name} cannot be unpacked: {error.strerror}.",
                "Unpack it by hand where there is room and give the log inside it.",
            ) from None
        except UnusableInputError:
            raise
        except (
            Exception
        ) as error:  # whatever an unpacker meets in damaged bytes; each format has errors of its own
            raise _damaged(path) from error
        yield log


def _damaged(path: Path) -> UnusableInputError:
    return UnusableInputError(
        "packed",
        f"{path.name} cannot be unpacked: it is damaged, cut short or encrypted.",
        "Unpack it by hand and give the log inside it.",
    )


def _copy(packed: IO[bytes] | gzip.GzipFile, name: str, packed_bytes: int, to: Path) -> Path:
    """Unpack a log to a file, after its beginning was recognised as a log."""
    beginning = packed.read(BEGINNING_BYTES)
    if recognised(beginning) is None:
        raise UnusableInputError.of([refusal(f"{name}, unpacked,", beginning)])
    largest = min(LARGEST_UNPACKED_BYTES, max(MOST_TIMES * packed_bytes, _SMALL_BYTES))
    with to.open("wb") as file:
        file.write(beginning)
        while chunk := packed.read(BEGINNING_BYTES):
            if file.tell() + len(chunk) > largest:
                raise UnusableInputError(
                    "too_large",
                    f"{name} of {packed_bytes / 1e6:.1f} MB unpacks to more than {largest / 1e6:.0f} MB.",
                    "Unpack it by hand and cut out the flight.",
                )
            file.write(chunk)
    return to


def _only_log(archive: zipfile.ZipFile, name: str) -> zipfile.ZipInfo:
    logs = []
    for member in archive.infolist()[:_MOST_MEMBERS]:
        if member.is_dir() or member.filename.startswith("__MACOSX/"):
            continue
        with archive.open(member) as packed:
            if recognised(packed.read(BEGINNING_BYTES)) is not None:
                logs.append(member)
    if not logs:
        raise UnusableInputError(
            "packed", f"{name} holds no log.", "Put one .tlog, .bin or .ulg into it, or give the log itself."
        )
    if len(logs) > 1:
        names = [_shown(member) for member in logs]
        more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
        raise UnusableInputError(
            "several_logs",
            f"{name} holds {len(names)} logs: {', '.join(names[:_NAMED])}{more}.",
            "Unpack it and give one of them; gap takes several.",
        )
    return logs[0]


def _shown(member: zipfile.ZipInfo) -> str:
    """Return the name of a member without control characters."""
    return "".join(letter for letter in member.filename if letter.isprintable())
