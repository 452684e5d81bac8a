"""Files of recordings: their names, creation and continuation."""

import contextlib
import os
import tempfile
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

import platformdirs

from advisor.mavlink.wire.framing import CRC_EXTRA, LONGEST_FRAME, MAGIC, FrameCutter
from advisor.words.problems import UnusableInputError

_TAIL_BYTES = 65_536
"""Bytes at the end of a recording in which the last complete record is sought."""


def default_recording(folder: Path | None = None, now: datetime | None = None) -> Path:
    """Return the path of a recording that the user does not name.

    Parameters
    ----------
    folder
        Folder of the recording; None for the user's recordings folder.
    now
        Start of the flight; None for this moment.

    Returns
    -------
    Path
        One file for each flight, named by the start in UTC.
    """
    stamp = (now or datetime.now(UTC)).strftime("%Y-%m-%dT%H-%M-%SZ")
    return (folder or recordings_folder()) / f"{stamp}.tlog"


def recordings_folder() -> Path:
    """Return the user's own folder of recordings."""
    return Path(platformdirs.user_data_dir("inflight-advisor")) / "recordings"


def writable_folder() -> tuple[Path, str]:
    """Return a folder for an unnamed recording, and a sentence if it is not the usual folder.

    A full, read-only or missing home folder prevents no advice.
    """
    own = recordings_folder()
    try:
        own.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=own):
            return own, ""
    except OSError as error:
        other = Path(tempfile.mkdtemp(prefix="advisor-recordings-"))
        return other, (
            f"{own} takes no recording ({error.strerror or error}). The system may clear {other}: "
            "copy the recording after landing"
        )


def create(path: Path) -> tuple[Path, BinaryIO]:
    """Make a new file for a recording; a number is added to a name that exists.

    Raises
    ------
    UnusableInputError
        No file can be created at the path.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for number in range(1, 1000):
            candidate = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
            with contextlib.suppress(FileExistsError):
                return candidate, _alone(candidate, candidate.open("xb", buffering=0))
    except OSError as error:
        raise UnusableInputError(
            "recording",
            f"The recording {path} cannot be made: {error.strerror}.",
            "Name another place with --record, or turn recording off with --no-record.",
        ) from None
    raise UnusableInputError("recording", f"{path} exists many times.", "Name another place with --record.")


def take_up(path: Path) -> tuple[Path, BinaryIO]:
    """Open a recording after its last complete record. A last record that a power cut broke is removed.

    Raises
    ------
    UnusableInputError
        The file is no telemetry log, is in use by another recorder, or cannot be opened.
    """
    try:
        file = _alone(path, path.open("r+b", buffering=0))
        try:
            end = _end_of_whole_records(file, path)
            file.truncate(end)
            file.seek(end)
        except BaseException:
            file.close()
            raise
    except OSError as error:
        raise UnusableInputError(
            "recording",
            f"The recording {path} cannot be resumed: {error.strerror}.",
            "Name another recording with --resume, or a new place with --record.",
        ) from None
    return path, file


def _end_of_whole_records(file: BinaryIO, path: Path) -> int:
    """Return the end of the last whole record, bytes; a power cut breaks what follows."""
    size = file.seek(0, os.SEEK_END)
    start = max(0, size - _TAIL_BYTES)
    file.seek(start)
    tail = file.read(_TAIL_BYTES)
    end = _last_frame_ends(tail)
    # A time stamp may look like the head of a frame that the file does not hold whole.
    for at in range(max(end, size - start - LONGEST_FRAME), size - start):
        if tail[at] in MAGIC and (length := _last_frame_ends(tail[at:])):
            end = max(end, at + length)
    if end == 0 and (start or tail.strip(b"\0")):
        raise UnusableInputError(
            "recording",
            f"{path} does not end like a telemetry log: nothing is appended to it.",
            "Give --record a new file; --resume then reads the old one and leaves it alone.",
        )
    return start + end


def _last_frame_ends(data: bytes) -> int:
    """Return the end of the last frame that the cutter finds; 0 without a frame."""
    frames = FrameCutter(CRC_EXTRA).feed(data)
    return data.rindex(frames[-1].raw) + len(frames[-1].raw) if frames else 0


def _alone(path: Path, file: BinaryIO) -> BinaryIO:
    """Lock the file against a second recorder, if the system can."""
    try:
        import fcntl
    except ImportError:  # Windows opens no file for writing twice in one program, and has no such lock
        return file
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        file.close()
        raise UnusableInputError(
            "recording",
            f"{path} is being recorded by another program.",
            "End that program, or give --record a new file.",
        ) from None
    except OSError:  # a file system without locks
        pass
    return file
