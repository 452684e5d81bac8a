"""Format of a log file, recognised by its content and never by its name."""

from dataclasses import dataclass

from advisor.mavlink.logs.formats import FORMATS, GIVE, LogFormat
from advisor.words.problems import Problem

BEGINNING_BYTES = 1 << 20
"""Number of bytes at the start of a file in which the log must begin. A few lines of text may stand in front
of a log. A megabyte is read in milliseconds, so huge and packed files are refused quickly.
"""

_ARCHIVES = {
    b"BZh": "bzip2",
    b"\xfd7zXZ\0": "xz",
    b"7z\xbc\xaf": "7-Zip",
    b"Rar!": "RAR",
    b"\x28\xb5\x2f\xfd": "zstd",
}
"""Name of each archive that the advisor does not unpack, by its first bytes."""
_OTHERS: tuple[tuple[bytes, str, str, str], ...] = (
    (b"H Product:Blackbox", "blackbox", "is a Blackbox log of Betaflight or INAV",
     "Decode it with blackbox_decode, and name the columns of its CSV in the aircraft file (columns:)."),
    (b"#ROSBAG V", "ros_bag", "is a bag of ROS 1",
     "Write its topics into one CSV with a header line, such as with: rostopic echo -b FILE -p TOPIC."),
    (b"SQLite format 3\0", "database", "is an SQLite database, such as a bag of ROS 2 (.db3)",
     "Write its topics into one CSV with a header line: time, rates, surfaces."),
    (b"\x89MCAP0\r\n", "mcap", "is an MCAP recording",
     "Write its topics into one CSV with a header line: time, rates, surfaces."),
    (b"PAR1", "parquet", "is a Parquet table", "Write it as CSV: pandas.read_parquet(FILE).to_csv(CSV)."),
    (b"\x93NUMPY", "numpy", "is an array of NumPy without names of columns",
     "Write it as CSV with a header line: time, rates, surfaces."),
    (b"\xd4\xc3\xb2\xa1", "capture", "is a capture of network packets (pcap)",
     "Play it to the advisor with tcpreplay: advisor live --master udpin:0.0.0.0:14550."),
    (b"\x0a\x0d\x0d\x0a", "capture", "is a capture of network packets (pcapng)",
     "Play it to the advisor with tcpreplay: advisor live --master udpin:0.0.0.0:14550."),
    (b"<?xml", "xml", "is XML, such as a track of GPX or KML",
     "Give the autopilot's own log, or a CSV with time, rates and surfaces."),
    (b"{", "json", "is JSON", "Write its series as CSV with a header line, one row for each time."),
    (b"[", "json", "is JSON", "Write its series as CSV with a header line, one row for each time."),
)  # fmt: skip
"""First bytes, code, name and remedy of files that people have instead of a log."""
_PACKED_INSIDE = (b"\x1f\x8b", b"PK\x03\x04")


@dataclass(frozen=True, slots=True)
class Found:
    """A log whose format was recognised."""

    format: LogFormat
    starts_at: int
    """Number of bytes before the log's first record."""


def recognised(beginning: bytes) -> Found | None:
    """Return the log that begins first within the first ``BEGINNING_BYTES`` of a file; None for no log.

    A format without fixed first bytes is tried if no other format begins.
    """
    for has_magic in (True, False):
        there = [
            Found(log_format, at)
            for log_format in FORMATS
            if log_format.has_magic is has_magic and (at := log_format.begins_at(beginning)) is not None
        ]
        if there:
            return min(there, key=lambda origin: origin.starts_at)
    return None


def refusal(name: str, beginning: bytes) -> Problem:
    """Return a problem with the reason why a file is no log, and with the remedy."""
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
    for magic, code, kind, fix in _OTHERS:
        if beginning.removeprefix(b"\xef\xbb\xbf").startswith(magic):
            return Problem(code, f"{name} {kind}, which the advisor does not read.", fix)
    for log_format in FORMATS:
        if refused := log_format.refusal(name, beginning):
            return refused
    archive = next((kind for magic, kind in _ARCHIVES.items() if beginning.startswith(magic)), None)
    if archive is not None or beginning.startswith(_PACKED_INSIDE):
        return Problem(
            "packed",
            f"{name} is packed{f' with {archive}' if archive else ' twice'}.",
            "Unpack it and give the log inside it.",
        )
    holds = f"{', '.join(log_format.holds for log_format in FORMATS[:-1])} or {FORMATS[-1].holds}"
    return Problem("not_a_tlog", f"{name} holds no {holds} ({len(beginning)} bytes read).", GIVE)
