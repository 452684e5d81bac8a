"""Recording of the link: a tlog that loses at most its last second in a power cut, and the file of its
name.
"""

import contextlib
import os
import shutil
import tempfile
import threading
import time
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

import platformdirs

from advisor.mavlink.wire.framing import CRC_EXTRA, LONGEST_FRAME, MAGIC, FrameCutter
from advisor.process.liveness import OLD_AFTER_S
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


WRITE_EVERY_S = 0.05
"""Time between two writes to the operating system, s. If this process ends abruptly, at most the records of
this time are lost."""
SYNC_EVERY_S = 0.5
"""Time between two synchronisations with the disk, s. A power cut loses at most the records of this time and
of one write."""
RETRY_EVERY_S = 1.0
MOST_UNSAVED_BYTES = 64_000_000
"""Largest number of bytes that wait in memory while the disk fails: 17 minutes at 60 kB/s."""
LITTLE_SPACE_BYTES = 200_000_000
"""Free space on the disk, bytes, below which the crew is warned: one hour at 60 kB/s."""


@dataclass(frozen=True, slots=True)
class Recorded:
    """Progress of a recording."""

    written: int
    """Number of bytes in the file, which ends with a complete record."""
    unsaved: bytes
    """Records in memory that are not in the file yet."""


class Recorder:
    """Recorder that appends complete tlog records to a file, in a separate thread.

    A slow disk delays no packet, because the recorder's own thread writes. A failing disk ends neither the
    link nor the recording. Records wait in memory, and the recorder tries again every ``RETRY_EVERY_S``. The
    file always ends with a complete record.

    Parameters
    ----------
    path
        File to be created, including its folder. When the file exists, a number is added to the name.
    goes_on
        Whether an existing file is continued after its last complete record.

    Raises
    ------
    UnusableInputError
        The file cannot be made. The error is also raised if the existing file is no recording, or is in use.
    """

    def __init__(self, path: Path, goes_on: bool = False) -> None:
        self.path, self._file = take_up(path) if goes_on else create(path)
        self._written = self._file.tell()
        self.before = self._written
        """Number of bytes in the recording from an earlier flight."""
        self._problem: str | None = None
        self._busy_since_s: float | None = None
        self._stuck_told = False
        self._notices: list[str] = []
        self._pending = bytearray()
        self._dropped = 0
        self._lock = threading.Lock()
        self._synced_s = self._failed_s = -RETRY_EVERY_S
        self._dirty = self._little_told = False
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._look_at_space()
        self._thread.start()

    @property
    def bytes_written(self) -> int:
        """Number of bytes added to the file since it was opened."""
        return self._written - self.before

    @property
    def problem(self) -> str | None:
        """Reason why records wait in memory at this moment; None while none must wait."""
        return self._stuck or self._problem

    @property
    def _stuck(self) -> str | None:
        """Clause about a disk that does not answer; None while the disk answers."""
        since_s = self._busy_since_s
        if since_s is None or (waits_s := time.monotonic() - since_s) < OLD_AFTER_S:
            return None
        return f"the disk has not answered for {waits_s:.0f} s; what is heard waits in memory"

    def write(self, records: bytes) -> None:
        with self._lock:
            if len(self._pending) + len(records) > MOST_UNSAVED_BYTES:
                self._dropped += len(records)
            else:
                self._pending += records

    def recorded(self) -> Recorded:
        """Return the bytes in the file and the records in memory."""
        with self._lock:
            return Recorded(self._written, bytes(self._pending))

    def take_notices(self) -> list[str]:
        """Return sentences about the disk for the crew, since the last call."""
        stuck = self._stuck
        if (stuck is not None) != self._stuck_told:
            self._stuck_told = stuck is not None
            self._say(f"recording to {self.path}: {stuck or 'the disk answers again'}")
        with self._lock:
            notices, self._notices = self._notices, []
        return notices

    def close(self) -> None:
        """Write the waiting records and close the file."""
        self._stop.set()
        self._thread.join()
        self._failed_s = self._synced_s = -RETRY_EVERY_S
        self._step()
        with contextlib.suppress(OSError):  # told already, in ``problem``
            self._file.close()

    def _run(self) -> None:
        while not self._stop.wait(WRITE_EVERY_S):
            self._step()

    def _step(self) -> None:
        """Write the waiting records, and synchronise the file if due."""
        now_s = time.monotonic()
        if now_s - self._failed_s < RETRY_EVERY_S:
            return
        self._busy_since_s = now_s
        try:
            self._append()
            if self._dirty and now_s - self._synced_s >= SYNC_EVERY_S:
                os.fsync(self._file.fileno())
                self._dirty, self._synced_s = False, now_s
                self._look_at_space()
        except OSError as error:
            self._fail(error, now_s)
        else:
            self._recover()
        finally:
            self._busy_since_s = None

    def _append(self) -> None:
        with self._lock:
            records = bytes(self._pending)
        if not records:
            return
        try:
            at = 0
            while at < len(records):
                at += os.write(self._file.fileno(), records[at:])
        except OSError:
            # The written part of a batch may end within a record; the batch is written again as a whole.
            with contextlib.suppress(OSError):
                self._file.truncate(self._written)
                self._file.seek(self._written)
            raise
        with self._lock:
            del self._pending[: len(records)]
            self._written += len(records)
        self._dirty = True

    def _fail(self, error: OSError, now_s: float) -> None:
        self._failed_s = now_s
        if self._problem is None:
            self._say(
                f"recording to {self.path} fails: {error.strerror or error}. What is heard waits in memory; "
                "make room on the disk"
            )
        self._problem = f"the disk takes no recording: {error.strerror or error}"

    def _recover(self) -> None:
        if self._problem is None:
            return
        self._problem = None
        with self._lock:
            lost, self._dropped = self._dropped, 0
        what = f"{lost / 1e6:.1f} MB are lost" if lost else "nothing is lost"
        self._say(f"recording to {self.path} goes on: {what}")

    def _look_at_space(self) -> None:
        with contextlib.suppress(OSError):
            free = shutil.disk_usage(self.path.parent).free
            if free < LITTLE_SPACE_BYTES and not self._little_told:
                self._little_told = True
                self._say(f"only {free / 1e6:.0f} MB are free where the recording goes: make room")

    def _say(self, text: str) -> None:
        with self._lock:
            self._notices.append(text)
