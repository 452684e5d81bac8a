"""Formats of logs, with one module for each format.

A new module in this folder is added automatically.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from pkgutil import iter_modules

from advisor.aircraft.aircraft import TableColumns
from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import Problem

Read = Callable[[Path, Iterable[str] | None, int, FrameScanner], Iterator[list[Columns]]]
"""Function that streams the messages of a log. The arguments are the path, the wanted messages (None: all),
the bytes before the first record, and a scanner."""


def nothing_refused(name: str, beginning: bytes) -> Problem | None:
    """Return None, because the format has no unreadable variant that a user may give."""
    return None


@dataclass(frozen=True, slots=True)
class LogFormat:
    """Format of a log file. Each module of ``advisor.mavlink.logs.formats`` makes one ``LogFormat``."""

    holds: str
    """Content of a log in words: ``DataFlash records``."""
    given: str
    """Words with which a user names such a log: ``an ArduPilot .bin``."""
    ending: str
    """Usual file ending. Usual ending of the file's name; only the content decides on the format."""
    begins_at: Callable[[bytes], int | None]
    """Function that returns the bytes before the first record; None for another kind of file."""
    read: Read
    refusal: Callable[[str, bytes], Problem | None] = nothing_refused
    """Function that returns a problem for an unreadable variant of the format, such as an encrypted log. The
    arguments are the file's name and its beginning.
    """
    read_columns: Callable[[Path, TableColumns], Iterator[list[Columns]]] | None = None
    """Function that streams the messages of a table, whose columns the aircraft file may name. None for a log
    whose own names are fixed.
    """
    has_magic: bool = True
    """Whether the format has fixed first bytes. Telemetry has none, and is tried last."""


def _found() -> Iterator[LogFormat]:
    for module in iter_modules(__path__, f"{__name__}."):
        yield import_module(module.name).FORMAT


FORMATS: tuple[LogFormat, ...] = tuple(sorted(_found(), key=lambda kind: (kind.has_magic, kind.ending)))
"""All formats, telemetry first, in the order of the user's sentence."""
ENDINGS: tuple[str, ...] = tuple(kind.ending for kind in FORMATS if kind.read_columns is None)
"""Usual file endings of the logs for which a folder is searched. Most tables in a folder are no flights."""
GIVE = f"Give {', '.join(kind.given for kind in FORMATS[:-1])} or {FORMATS[-1].given}."
"""Sentence that lists the readable logs."""
