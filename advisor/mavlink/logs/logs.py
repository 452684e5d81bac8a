"""Opening of a log of any kind, packed or not."""

from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import TableColumns
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.identity import READER
from advisor.mavlink.logs.kinds import Found, recognised, refusal
from advisor.mavlink.logs.unpack import beginning_of, unpacked
from advisor.mavlink.records.equivalent import message
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import ConfigurationError, UnusableInputError


def open_log(
    path: Path,
    wanted: Iterable[str] | None = None,
    scanner: FrameScanner | None = None,
    columns: TableColumns | None = None,
) -> Iterator[list[Columns]]:
    """Stream the messages of a ``.tlog``, an ArduPilot ``.bin``, a PX4 ``.ulg`` or a table, packed or not.

    A ``.bin`` and a ``.ulg`` contain the autopilot's own records. Records become
    the messages that telemetry would have carried, in one batch.

    Parameters
    ----------
    path : Path
    wanted : iterable of str, optional
        Names of the messages to return. None for all messages that MAVLink defines.
    scanner : FrameScanner, optional
        Scanner for a tlog instead of one made with ``wanted``, whose statistics the caller uses.
    columns : TableColumns, optional
        Names of a table's columns; None for usual names.

    Raises
    ------
    UnusableInputError
        The file is missing, or is not a regular file. The reading has found no messages.
    """
    return _read(path, beginning_of(path), wanted, scanner or FrameScanner(wanted), columns)


def _read(
    path: Path,
    beginning: bytes,
    wanted: Iterable[str] | None,
    scanner: FrameScanner,
    columns: TableColumns | None,
) -> Iterator[list[Columns]]:
    """Yield the messages of one log. An error of the reader ends this log only, with a sentence."""
    try:
        yield from _messages(path, beginning, wanted, scanner, columns)
    except (UnusableInputError, ConfigurationError):
        raise
    except MemoryError as error:
        raise UnusableInputError(
            "too_large", f"{path.name} needs more memory than is free.", "Cut out the flight, or free memory."
        ) from error
    except Exception as error:
        raise UnusableInputError(
            "damaged",
            f"{path.name} cannot be read, because the reader failed on its bytes ({type(error).__name__}: "
            f"{error}).",
            "Copy the log from the vehicle once more, or leave it out. Please report this error.",
        ) from error


def _messages(
    path: Path,
    beginning: bytes,
    wanted: Iterable[str] | None,
    scanner: FrameScanner,
    columns: TableColumns | None,
) -> Iterator[list[Columns]]:
    with unpacked(path, beginning) as log:
        if log is not path:
            beginning = beginning_of(log)
        origin = recognised(beginning)
        if origin is None:
            raise UnusableInputError.of([refusal(log.name, beginning)])
        if columns is not None and origin.format.read_columns is not None:
            yield from origin.format.read_columns(log, columns)
            return
        for number, batch in enumerate(origin.format.read(log, wanted, origin.starts_at, scanner)):
            yield [_skipped(origin, batch), *batch] if origin.starts_at and number == 0 else batch


def _skipped(origin: Found, first: list[Columns]) -> Columns:
    """Return a note about bytes before the first record, placed before the first messages."""
    text = f"{READER.decode()}{origin.starts_at} bytes in front of the first record were skipped"
    return message(
        "STATUSTEXT",
        first[0].system,
        np.array([-1]),
        np.array([min(float(c.arrival_s[0]) for c in first)]),
        {"severity": 6, "text": np.array([text.encode()])},
        first[0].carrier,
    )
