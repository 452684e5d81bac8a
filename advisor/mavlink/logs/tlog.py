"""Telemetry logs of ground stations (``.tlog``): sequences of time stamps and frames."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import UnusableInputError

CHUNK_BYTES = 1 << 20

_HARDLY_ANY = 0.01


def read_tlog(
    path: Path, wanted: Iterable[str] | None = None, chunk_bytes: int = CHUNK_BYTES
) -> Iterator[list[Columns]]:
    """Stream a log of any size: columns chunk by chunk.

    Parameters
    ----------
    path : Path
    wanted : iterable of str, optional
        Names of the messages to decode. None for all defined messages.
    chunk_bytes : int
        Number of bytes read at a time. The messages do not depend on this number.

    Raises
    ------
    UnusableInputError
        The file contains no MAVLink. The error is raised at the end of the file.
    """
    return scan_tlog(path, FrameScanner(wanted), chunk_bytes)


def scan_tlog(path: Path, scanner: FrameScanner, chunk_bytes: int = CHUNK_BYTES) -> Iterator[list[Columns]]:
    """Stream a log through the caller's scanner, which collects statistics."""
    size = 0
    with path.open("rb") as file:
        while chunk := file.read(chunk_bytes):
            size += len(chunk)
            if columns := scanner.feed(chunk):
                yield columns
    if columns := scanner.close():
        yield columns
    statistics = scanner.statistics
    # In noise a checksum is right once in 65536 times, so that a frame or two prove nothing.
    if statistics.known_frames == 0 or size - statistics.skipped_bytes < _HARDLY_ANY * size:
        raise UnusableInputError(
            "not_a_tlog",
            f"{path.name} holds no MAVLink messages ({size} bytes read).",
            "Give a .tlog as a ground station records it, an ArduPilot .bin or a PX4 .ulg.",
        )
