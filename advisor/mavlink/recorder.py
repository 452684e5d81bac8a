"""The link's own recording: a tlog that a power cut cannot rob of more than its last second."""

import contextlib
import os
import threading
from datetime import UTC, datetime
from pathlib import Path
from typing import BinaryIO

import platformdirs

from advisor.problems import UnusableInputError

FLUSH_EVERY_S = 0.5


def default_recording(now: datetime | None = None) -> Path:
    """Where a recording goes when the user names no place: one file a flight, named by its start in UTC."""
    stamp = (now or datetime.now(UTC)).strftime("%Y-%m-%dT%H-%M-%SZ")
    return Path(platformdirs.user_data_dir("inflight-advisor")) / "recordings" / f"{stamp}.tlog"


class Recorder:
    """Appends whole tlog records to a file from a thread of its own.

    Writing and waiting for the disk happen beside the reader, so that a slow disk cannot
    delay a packet. What was handed over is on the disk, not only with the operating
    system, at most ``FLUSH_EVERY_S`` and one write later. A disk that fails ends the
    recording, never the link: see ``problem``.

    Parameters
    ----------
    path
        File to make; its folder is made too. When it exists, a number is added to its name.

    Raises
    ------
    UnusableInputError
        When no file can be made there.
    """

    def __init__(self, path: Path) -> None:
        self.path, self._file = _create(path)
        self.bytes_written = 0
        self.problem: str | None = None
        """Why recording stopped before its time; None while all is well."""
        self._pending = bytearray()
        self._lock = threading.Lock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="recorder", daemon=True)
        self._thread.start()

    def write(self, records: bytes) -> None:
        """Hand over whole records."""
        if self.problem is None:
            with self._lock:
                self._pending += records

    def close(self) -> None:
        """Write what is left and close the file."""
        self._stop.set()
        self._thread.join()
        self._flush()
        with contextlib.suppress(OSError):  # told already, in ``problem``
            self._file.close()

    def _run(self) -> None:
        while not self._stop.wait(FLUSH_EVERY_S):
            self._flush()

    def _flush(self) -> None:
        with self._lock:
            records, self._pending = self._pending, bytearray()
        if not records or self.problem is not None:
            return
        try:
            self._file.write(records)
            self._file.flush()
            os.fsync(self._file.fileno())
        except OSError as error:
            self.problem = f"recording to {self.path} stopped: {error.strerror}"
            return
        self.bytes_written += len(records)


def _create(path: Path) -> tuple[Path, BinaryIO]:
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        for number in range(1, 1000):
            candidate = path if number == 1 else path.with_stem(f"{path.stem}-{number}")
            with contextlib.suppress(FileExistsError):
                return candidate, candidate.open("xb")
    except OSError as error:
        raise UnusableInputError(
            "recording",
            f"The recording {path} cannot be made: {error.strerror}.",
            "Name another place with --record, or turn recording off with --no-record.",
        ) from None
    raise UnusableInputError("recording", f"{path} exists many times.", "Name another place with --record.")
