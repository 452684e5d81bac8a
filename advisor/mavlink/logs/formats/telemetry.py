"""Telemetry as a ground station records it (``.tlog``), with or without stamps."""

from collections.abc import Iterable, Iterator
from pathlib import Path

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.scan import STAMP_BYTES
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


_BLOCK_BYTES = 1 << 14
"""Number of bytes that are scanned together for the first message."""


def _begins_at(beginning: bytes) -> int | None:
    scanner = FrameScanner()
    blocks = (beginning[at : at + _BLOCK_BYTES] for at in range(0, len(beginning), _BLOCK_BYTES))
    columns = next(filter(None, map(scanner.feed, blocks)), None) or scanner.close()
    if not columns:
        return None
    front = FrameScanner(())
    front.feed(beginning[: min(int(c.order[0]) for c in columns)])
    front.close()
    # The stamp of the first record is found only with its frame: the scanner has counted it as skipped.
    return max(0, front.statistics.skipped_bytes - STAMP_BYTES)


FORMAT = LogFormat(
    holds="MAVLink messages",
    given="a .tlog as a ground station records it",
    ending=".tlog",
    begins_at=_begins_at,
    read=lambda path, wanted, starts_at, scanner: scan_tlog(path, scanner),
    has_magic=False,
)
