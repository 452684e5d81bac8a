"""A series of logs, and the file of decisions by hand next to each: ``flight.maneuvers.yaml`` next to
``flight.tlog``.

Times are seconds since power-on. Every command that reads the log also reads this file.

``Campaign.feed`` takes the columns of a series unchanged. A link after the logs is the next flight.
"""

import os
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any, TypeVar

import numpy as np
import yaml
from pydantic import StringConstraints

from advisor.aircraft.aircraft import TableColumns
from advisor.campaign.state import ByHand, Remark, on_all
from advisor.flight.maneuvers.marks import LONGEST_S, Mark
from advisor.flight.signals.messages import Columns
from advisor.process.atomic_file import write_atomically
from advisor.process.settings_file import must, read_settings, strict
from advisor.words.problems import Problem, UnusableInputError, printable
from advisor.words.quantities import stretch

SUFFIX = ".maneuvers.yaml"
_TEXT_KEYS = {"excluded": "because", "notes": "text", "remarks": "text"}
"""Key of the sentence in each section of the file, by the section's name. Sections have the names of the
fields of ``ByHand``."""
_MEND = "Fix the file, move it away, or give --no-marks."
_HEADING = (
    "# Decided by hand; times in vehicle seconds since power-on. `advisor` reads this file with its log.\n"
)


_Seconds = Annotated[float, must("a number of seconds since power-on")]
_PowerOn = Annotated[int, must("the number of a power-on, 0 for the first", lambda x: x >= 0 and x == int(x))]
_Text = Annotated[str, StringConstraints(min_length=1)]


@strict
@dataclass(frozen=True)
class _Stretch:
    start_s: _Seconds
    end_s: _Seconds
    # Whoever edits the file need not know of power-ons: the first power-on that holds the stretch is meant.
    boot: _PowerOn | None = None


@strict
@dataclass(frozen=True)
class _Excluded:
    at_s: _Seconds
    because: _Text
    boot: _PowerOn = 0


@strict
@dataclass(frozen=True)
class _Noted:
    at_s: _Seconds
    text: _Text
    boot: _PowerOn = 0


@strict
@dataclass(frozen=True)
class _Decided:
    maneuvers: list[_Stretch] = field(default_factory=list)
    excluded: list[_Excluded] = field(default_factory=list)
    notes: list[_Noted] = field(default_factory=list)
    remarks: list[_Noted] = field(default_factory=list)


def _out_of_order(decided: _Decided) -> Iterator[str]:
    for i, mark in enumerate(decided.maneuvers):
        if not 0.0 < mark.end_s - mark.start_s <= LONGEST_S:
            yield f"maneuvers[{i}]: end_s must lie after start_s, by at most {LONGEST_S:.0f} s"


def path_beside(log: Path) -> Path:
    """Return the path of the file of decisions on a log."""
    return log.parent / f"{log.stem}{SUFFIX}"


def read_by_hand(log: Path) -> ByHand:
    """Read the decisions by hand on a log. Without such a file there are no decisions by hand.

    Raises
    ------
    ConfigurationError
        The file cannot be read, is not YAML, or holds unknown keys or unusable values.
    """
    path = path_beside(log)
    if not os.path.exists(path):  # no path at all counts, too: the log itself is refused later
        return ByHand()
    decided = read_settings(path, _Decided, _MEND, _out_of_order)
    marks = tuple(
        Mark(m.start_s, m.end_s, m.boot, name=f"{path.name}: the mark from {stretch(m.start_s, m.end_s)}")
        for m in decided.maneuvers
    )
    remarks = {
        section: tuple(Remark(r.at_s, getattr(r, key), r.boot) for r in getattr(decided, section))
        for section, key in _TEXT_KEYS.items()
    }
    return ByHand(marks, **remarks)


def write_by_hand(log: Path, by_hand: ByHand) -> None:
    """Write the decisions next to a log. The file is always complete, with the old or the new content, even
    after a power failure.

    Raises
    ------
    OSError
        The file cannot be written.
    """
    path = path_beside(log)
    sections: dict[str, list[dict[str, Any]]] = {
        "maneuvers": [
            {"start_s": mark.start_s, "end_s": mark.end_s, **_boot(mark.boot)} for mark in by_hand.marks
        ]
    }
    for section, key in _TEXT_KEYS.items():
        remarks: Sequence[Remark] = getattr(by_hand, section)
        sections[section] = [{"at_s": r.at_s, key: r.text, **_boot(r.boot)} for r in remarks]
    filled = {name: entries for name, entries in sections.items() if entries}
    text = _HEADING + (yaml.safe_dump(filled, sort_keys=False, allow_unicode=True) if filled else "")
    write_atomically(path, text)


def keep_by_hand(log: Path, by_hand: ByHand) -> str:
    """Write the decisions next to a log; return a sentence with the file's path or the failure's reason."""
    path = printable(str(path_beside(log)))
    try:
        write_by_hand(log, by_hand)
    except OSError as error:
        return (
            f"decisions by hand cannot be kept in {path}: {error.strerror or error}; they hold until you quit"
        )
    return f"decisions by hand are kept in {path}"


def keep_on_all(logs: Sequence[Path], before: ByHand, by_hand: ByHand) -> str:
    """Write the decisions on a campaign, each next to its log, if they differ from ``before``."""
    flights = [n for n in range(len(logs)) if by_hand.on_flight(n) != before.on_flight(n)]
    return "; ".join(keep_by_hand(logs[n], by_hand.on_flight(n)) for n in flights)


def _boot(boot: int | None) -> dict[str, int]:
    return {"boot": boot} if boot else {}


T = TypeVar("T")

SINCE_1970_S = 1e9
"""Earliest time of arrival that is a date, s since 1970 (a day in 2001). Times of a log without a date begin
at its boot and are smaller."""


class LogSeries:
    """The logs of one campaign in the order of their flights. The oldest log is first if every log has a
    date; else the given order is used.
    """

    def __init__(self, logs: Sequence[Path], columns: TableColumns | None = None) -> None:
        self._columns = columns
        self.logs = _oldest_first(logs) if len(logs) > 1 else list(logs)
        """Paths of the logs in the order of flights."""
        self.reordered = self.logs != list(logs)
        """Whether the order differs from the given order."""
        self.unreadable: dict[int, Problem] = {}
        """Reason for which a log ends early, by its flight number. The reasons are found while the logs are
        read."""
        self._left_out: set[int] = set()

    @property
    def names(self) -> list[str]:
        """Name of each log: the file's name, or the path if two files have the same name."""
        names = [log.name for log in self.logs]
        return [str(log) if names.count(log.name) > 1 else log.name for log in self.logs]

    @property
    def order_said(self) -> str:
        """Sentence on the order of the logs if it differs from the given order; else empty."""
        listed = ", ".join(self.names)
        return f"The logs are taken in the order of their times: {listed}." if self.reordered else ""

    def batches(self) -> Iterator[list[Columns]]:
        """Yield the messages of all logs. A log that cannot be read is omitted and listed in
        ``unreadable``."""
        for flight in sorted(set(range(len(self.logs))) - self._left_out):
            try:
                for columns in self._read(flight):
                    yield of_flight(columns, flight)
            except UnusableInputError as error:
                self.unreadable[flight] = error.problem

    def fed_to(self, make: Callable[[], T], feed: Callable[[T, list[Columns]], object]) -> T:
        """Feed all logs to a new consumer, and return the consumer.

        Of several logs, a log whose messages cause an error in the consumer is left out and listed in
        ``unreadable``. The logs that can be read are then fed to another new consumer. The error of a single
        log is raised.
        """
        while True:
            consumer, flight = make(), 0
            try:
                for columns in self.batches():
                    flight = columns[0].flight if columns else flight
                    feed(consumer, columns)
            except Exception as error:
                if len(self.logs) == 1:
                    raise
                self._left_out.add(flight)
                self.unreadable[flight] = Problem(
                    "fault",
                    f"Its messages cause an error in the analysis ({type(error).__name__}: "
                    f"{printable(str(error))}).",
                    "Leave this log out, and please report this error.",
                )
            else:
                return consumer

    def _read(self, flight: int) -> Iterator[list[Columns]]:
        """Yield the messages of one complete log. A log without parameters gets the parameters of the nearest
        log.
        """
        # The log reader takes longer to load than the first screen to paint.
        from advisor.mavlink.logs.logs import read_whole_log

        others = sorted(set(range(len(self.logs))) - {flight}, key=lambda n: (abs(n - flight), n))
        return read_whole_log(self.logs[flight], [self.logs[n] for n in others], columns=self._columns)

    def load(self) -> list[Columns]:
        """Return the messages of all logs that can be read.

        Raises
        ------
        UnusableInputError
            No log can be read.
        """
        columns = [column for batch in self.batches() for column in batch]
        if len(self.unreadable) == len(self.logs):
            raise UnusableInputError.of(list(self.unreadable.values()))
        return columns

    def said(self) -> list[str]:
        """Return sentences on the order of the logs, and on the logs that could not be read."""
        wrong = [problem.about(self.names[flight]) for flight, problem in self.unreadable.items()]
        return [*([self.order_said] if self.reordered else []), *wrong]

    def read_by_hand(self) -> ByHand:
        """Return the decisions by hand on every log.

        Raises
        ------
        ConfigurationError
            As :func:`advisor.analysis.marks_file.read_by_hand`.
        """
        return on_all([read_by_hand(log) for log in self.logs])


def of_flight(columns: Sequence[Columns], flight: int) -> list[Columns]:
    """Set the flight number of columns, and return the columns."""
    return [replace(c, flight=flight) for c in columns] if flight else list(columns)


def _oldest_first(logs: Sequence[Path]) -> list[Path]:
    begun_s = [began_s(log) for log in logs]
    if not all(at_s >= SINCE_1970_S for at_s in begun_s):
        return list(logs)
    return [log for _, log in sorted(zip(begun_s, logs, strict=True), key=lambda dated: dated[0])]


def began_s(log: Path) -> float:
    """Return the start time of a log, s since 1970. A log without dates gives a smaller number, and an
    unreadable log gives infinity."""
    from advisor.mavlink.logs.logs import open_log

    try:
        first = next(open_log(log), [])
    except UnusableInputError:
        return np.inf
    times = [c.arrival_s for c in first if len(c)]
    # A low quantile instead of the earliest, because single stamps may be wrong.
    return float(np.quantile(np.concatenate(times), 0.01)) if times else np.inf
