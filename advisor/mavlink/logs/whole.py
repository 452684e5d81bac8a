"""A log known as a whole: its parameters count from its first message, whenever they were written down.

Ground stations write PARAM_VALUE when their download is complete, some only after landing. A link cannot know
these values earlier. A file can.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from advisor.flight.signals.messages import Columns, cut
from advisor.flight.stream.identity import READER
from advisor.flight.vehicle.parameters import names_in, tells_of_outputs
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.records.equivalent import message
from advisor.mavlink.wire.frames import FrameScanner
from advisor.words.printable import printable
from advisor.words.problems import UnusableInputError


def read_whole_log(
    path: Path, others: Sequence[Path] = (), scanner: FrameScanner | None = None
) -> Iterator[list[Columns]]:
    """Stream the messages of a log after the first value of each parameter of the servo outputs.

    Parameters
    ----------
    path
        Log of any kind, as in :func:`advisor.mavlink.logs.logs.open_log`.
    others
        Other logs of the campaign, the nearest first. The first of them that states parameters lends these to
        a log without any.
    scanner
        Scanner for a tlog, for the sake of its statistics.

    Raises
    ------
    UnusableInputError
        As :func:`advisor.mavlink.logs.logs.open_log`.
    """
    batches = open_log(path, scanner=scanner)
    first = next(batches, None)
    if first is None:
        return
    known = _stated(open_log(path, ["PARAM_VALUE"])) if first[0].carrier == "telemetry" else _stated([first])
    lender = None
    if not known:
        lender, known = _lent(others)
    yield [*_in_front(first, known, lender), *first]
    yield from batches


def _stated(batches: Iterator[list[Columns]] | Sequence[list[Columns]]) -> list[Columns]:
    """Return the first value of each parameter of the servo outputs, one message each, by sender."""
    heard: set[tuple[int, int, str]] = set()
    found: list[Columns] = []
    for columns in (c for batch in batches for c in batch if c.name == "PARAM_VALUE"):
        rows = np.zeros(len(columns), dtype=bool)
        for row, name in enumerate(names_in(columns)):
            key = (columns.system, columns.component, name)
            rows[row] = tells_of_outputs(name) and key not in heard
            heard.add(key)
        if rows.any():
            found.append(cut(columns, rows))
    return found


def _lent(others: Sequence[Path]) -> tuple[Path | None, list[Columns]]:
    """Return the first log that states parameters, with the parameters; None without such a log."""
    for other in others:
        try:
            known = _stated(open_log(other, ["PARAM_VALUE"]))
        except UnusableInputError:
            continue
        if known:
            return other, known
    return None, []


def _in_front(first: Sequence[Columns], known: Sequence[Columns], lender: Path | None) -> list[Columns]:
    """Return parameters, and a note on the log that lends them, in front of the first messages of a log."""
    begins = min(int(c.order[0]) for c in first)
    began_s = min(float(c.arrival_s[0]) for c in first)
    place = begins - sum(map(len, known))
    moved: list[Columns] = []
    for columns in known:
        order = np.arange(place, place + len(columns))
        place += len(columns)
        moved.append(replace(columns, order=order, arrival_s=np.full(len(order), began_s)))
    if lender is None:
        return moved
    text = (
        f"{READER.decode()}The log states no parameters of its servo outputs. "
        f"Those of {printable(lender.name)} count"
    )
    note = message(
        "STATUSTEXT",
        known[0].system,
        moved[0].order[:1] - 1,
        moved[0].arrival_s[:1],
        {"severity": 6, "text": np.array([text.encode()])},
        first[0].carrier,
    )
    return [note, *moved]
