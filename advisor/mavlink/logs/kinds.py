"""Kind of a log file, recognised by its content and never by its name."""

import re
from dataclasses import dataclass
from typing import Literal

from advisor.mavlink.px4 import ulog
from advisor.mavlink.records import dataflash, record_scan
from advisor.mavlink.wire.frames import FrameScanner
from advisor.mavlink.wire.scan import STAMP_BYTES
from advisor.words.problems import Problem

BEGINNING_BYTES = 1 << 20
"""Bytes of a file within which its log must begin. Text in front of a log is a few lines. A megabyte is read
in milliseconds, so that huge and packed files are refused quickly."""

Kind = Literal["tlog", "dataflash", "ulog"]

_ARCHIVES = {
    b"BZh": "bzip2",
    b"\xfd7zXZ\0": "xz",
    b"7z\xbc\xaf": "7-Zip",
    b"Rar!": "RAR",
    b"\x28\xb5\x2f\xfd": "zstd",
}
"""First bytes of packed files that the advisor does not unpack, to the name of the archive."""
_TEXT_LOG = re.compile(rb"^FMT, ?\d+, ?\d+, ?\w+, ?\w+, ?\w+", re.MULTILINE)
"""A definition of records as text. Ground stations write a few lines about the vehicle before the first."""
_PACKED_INSIDE = (b"\x1f\x8b", b"PK\x03\x04")


@dataclass(frozen=True, slots=True)
class Found:
    """A log that has been recognised."""

    kind: Kind
    starts_at: int
    """Bytes before the log's first record."""


def recognised(beginning: bytes) -> Found | None:
    """Return the kind of log that begins within the first ``BEGINNING_BYTES`` of a file; None for no log."""
    if beginning.startswith(record_scan.HEADER):
        return Found("dataflash", 0)
    starts: dict[Kind, int] = {
        "dataflash": dataflash.first_definition(beginning),
        "ulog": beginning.find(ulog.MAGIC),
    }
    there = {kind: at for kind, at in starts.items() if at >= 0}
    if there:
        kind = min(there, key=lambda kind: there[kind])
        return Found(kind, there[kind])
    return _telemetry(beginning)


def _telemetry(beginning: bytes) -> Found | None:
    scanner = FrameScanner()
    columns = scanner.feed(beginning) + scanner.close()
    if not columns:
        return None
    front = FrameScanner(())
    front.feed(beginning[: min(int(c.order[0]) for c in columns)])
    front.close()
    # The stamp of the first record is found only with its frame: the scanner has counted it as skipped.
    return Found("tlog", max(0, front.statistics.skipped_bytes - STAMP_BYTES))


def refusal(name: str, beginning: bytes) -> Problem:
    """Return a problem with the reason for which a file is no log, and with the remedy.

    Parameters
    ----------
    name
        Name of the file in the sentence.
    beginning
        Beginning of the file, in which :func:`recognised` finds no log.
    """
    text = beginning[:1024].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    if not beginning:
        return Problem("empty", f"{name} is empty.", "Give a log that was recorded to its end.")
    if text.startswith(b"version https://git-lfs"):
        return Problem(
            "git_lfs",
            f"{name} is a Git LFS pointer of {len(beginning)} bytes, not the log itself.",
            "Fetch the log with: git lfs pull.",
        )
    if text.startswith((b"<!doctype html", b"<html")) or b"<html" in text:
        return Problem(
            "web_page",
            f"{name} is a web page, not a log.",
            "Download the file itself, not the page that shows it.",
        )
    if beginning.startswith(b"ULogEnc"):
        return Problem(
            "encrypted",
            f"{name} is an encrypted log of PX4.",
            "Decrypt it with PX4's Tools/decrypt_ulog.py and the private key, and give the .ulg.",
        )
    if _TEXT_LOG.search(beginning):
        return Problem(
            "text_log",
            f"{name} is a DataFlash log written as text.",
            "Give the .bin that it was made from.",
        )
    archive = next((kind for magic, kind in _ARCHIVES.items() if beginning.startswith(magic)), None)
    if archive is not None or beginning.startswith(_PACKED_INSIDE):
        return Problem(
            "packed",
            f"{name} is packed{f' with {archive}' if archive else ' twice'}.",
            "Unpack it and give the log inside it.",
        )
    return Problem(
        "not_a_tlog",
        f"{name} holds no MAVLink messages, DataFlash records or ULog ({len(beginning)} bytes read).",
        "Give a .tlog as a ground station records it, an ArduPilot .bin or a PX4 .ulg.",
    )
