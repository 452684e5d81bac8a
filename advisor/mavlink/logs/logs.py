"""Opening of a log of any kind, packed or not, whole or as it arrives.

Ground stations write PARAM_VALUE after a download, sometimes only after landing. The first vehicle in a log
may have stood idle. A reader of a file knows the flown vehicle and its parameters from the start, which a
link does not.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.aircraft.aircraft import TableColumns
from advisor.flight.signals.channels import ARMED
from advisor.flight.signals.messages import Columns, cut
from advisor.flight.stream.identity import READER
from advisor.flight.vehicle.parameters import Sender, names_in, tells_of_outputs
from advisor.flight.vehicle.vehicle import MULTICOPTERS, is_aircraft
from advisor.mavlink.logs.kinds import Found, recognised, refusal
from advisor.mavlink.logs.parameter_file import MESSAGE, stated_by_file
from advisor.mavlink.logs.unpack import beginning_of, unpacked
from advisor.mavlink.records.equivalent import message
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.problems import ConfigurationError, UnusableInputError, printable


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


_STATE = ("PARAM_VALUE", MESSAGE)
"""Messages that state parameters, one by one or as a file."""


def read_whole_log(
    path: Path,
    others: Sequence[Path] = (),
    scanner: FrameScanner | None = None,
    columns: TableColumns | None = None,
) -> Iterator[list[Columns]]:
    """Stream the messages of a log, with those about the whole log first.

    The first messages are the first value of each servo output parameter. The heartbeat of the flown vehicle
    is also first if another vehicle appears before it.

    Parameters
    ----------
    path
        Log of any kind, as in :func:`advisor.mavlink.logs.logs.open_log`.
    others
        Other logs of the campaign, the nearest first. The first other log with parameters supplies them to a
        log without any.
    scanner
        Scanner for a tlog, whose statistics the caller uses.
    columns
        Names of a table's columns; None for usual names.

    Raises
    ------
    UnusableInputError
        As :func:`advisor.mavlink.logs.logs.open_log`.
    """
    batches = open_log(path, scanner=scanner, columns=columns)
    first = next(batches, None)
    if first is None:
        return
    is_tlog = first[0].carrier == "telemetry"
    telling = list(open_log(path, ["HEARTBEAT", *_STATE], None, columns)) if is_tlog else [first]
    stated, notes = _stated(telling), []
    if not stated:
        lender, stated = _lent(others)
        if lender is not None:
            notes.append(
                "The log states no parameters of its servo outputs. "
                f"The parameters in {printable(lender.name)} count"
            )
    flew = _flew_though_heard_later(telling)
    if flew is not None:
        notes.append(
            f"Vehicle {flew.system} is followed: it alone was armed. Another vehicle was heard first"
        )
    yield [*_in_front(first, [*([flew] if flew else []), *stated], notes), *first]
    yield from batches


def _flew_though_heard_later(batches: Iterable[Sequence[Columns]]) -> Columns | None:
    """Return the first heartbeat of the only armed winged vehicle. Return None if the first vehicle or
    several vehicles were armed.
    """
    first: dict[Sender, Columns] = {}
    armed: set[Sender] = set()
    for columns in (c for batch in batches for c in batch if c.name == "HEARTBEAT" and len(c)):
        sender = (columns.system, columns.component)
        autopilot, kind = (int(columns.fields[name][0]) for name in ("autopilot", "type"))
        if is_aircraft(autopilot, kind):
            first.setdefault(sender, cut(columns, slice(0, 1)))
            if kind not in MULTICOPTERS and np.any(columns.fields["base_mode"] & ARMED):
                armed.add(sender)
    by_arrival = sorted(first, key=lambda sender: int(first[sender].order[0]))
    if not by_arrival or by_arrival[0] in armed or len(armed) != 1:
        return None
    return first[armed.pop()]


def _stated(batches: Iterable[Sequence[Columns]]) -> list[Columns]:
    """Return the first value of each parameter of the servo outputs, one message each, by sender."""
    heard: set[tuple[int, int, str]] = set()
    stated: list[Columns] = []
    all_heard = list(batches)
    singly = [c for batch in all_heard for c in batch if c.name == "PARAM_VALUE"]
    for columns in [*singly, *stated_by_file(all_heard)]:
        rows = np.zeros(len(columns), dtype=bool)
        for row, name in enumerate(names_in(columns)):
            key = (columns.system, columns.component, name)
            rows[row] = tells_of_outputs(name) and key not in heard
            heard.add(key)
        if rows.any():
            stated.append(cut(columns, rows))
    return stated


def _lent(others: Sequence[Path]) -> tuple[Path | None, list[Columns]]:
    """Return the first log that states parameters, with the parameters; None without such a log."""
    for other in others:
        try:
            stated = _stated(open_log(other, _STATE))
        except UnusableInputError:
            continue
        if stated:
            return other, stated
    return None, []


def _in_front(first: Sequence[Columns], stated: Sequence[Columns], notes: Sequence[str]) -> list[Columns]:
    """Return known messages and notes about them, before the first messages of a log."""
    begins = min(int(c.order[0]) for c in first)
    began_s = min(float(c.arrival_s[0]) for c in first)
    place = begins - sum(map(len, stated)) - len(notes)
    moved: list[Columns] = []
    for columns in stated:
        order = np.arange(place, place + len(columns))
        place += len(columns)
        moved.append(replace(columns, order=order, arrival_s=np.full(len(order), began_s)))
    if not notes:
        return moved
    statustext = message(
        "STATUSTEXT",
        first[0].system,
        np.arange(place, begins),
        np.full(len(notes), began_s),
        {"severity": 6, "text": np.array([READER + note.encode() for note in notes])},
        first[0].carrier,
    )
    return [*moved, statustext]
