"""Telemetry as a ground station records it (``.tlog``), with or without stamps."""

from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.logs.tlog import scan_tlog
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.scan import STAMP_BYTES

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
