"""One format of logs: how it begins, how it is read, how its files are named, and what it refuses."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import Problem

Read = Callable[[Path, Iterable[str] | None, int, FrameScanner], Iterator[list[Columns]]]
"""Function that streams the messages of a log. It takes the path and the names of the wanted messages (None:
all), then the bytes before the first record, and a scanner for telemetry."""


def nothing_refused(name: str, beginning: bytes) -> Problem | None:
    """Return None: the format has no relative that a user may give in its place."""
    return None


@dataclass(frozen=True, slots=True)
class LogFormat:
    """Format of a log file. A module of ``advisor.mavlink.logs.formats`` makes each."""

    holds: str
    """Content of a log in words: ``DataFlash records``."""
    given: str
    """How a user names such a log: ``an ArduPilot .bin``."""
    ending: str
    """Usual ending of the files. The content decides, never the name."""
    begins_at: Callable[[bytes], int | None]
    """Bytes before the first record within the beginning of a file; None: it holds no such log."""
    read: Read
    refusal: Callable[[str, bytes], Problem | None] = nothing_refused
    """Problem by a file's name and beginning, where the file is a relative of the format that cannot be read.
    An encrypted log is such a relative."""
    has_magic: bool = True
    """Whether fixed first bytes tell the format. Telemetry has none, and is tried last."""
