"""Several logs as one campaign, in the order of their true times. Each message carries the number of its
flight.

``Campaign.feed`` takes the columns of a series unchanged. A link after the logs is the next flight.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

import numpy as np

from advisor.aircraft.aircraft import TableColumns
from advisor.analysis.marks_file import read_by_hand
from advisor.campaign.hand_decisions import ByHand, on_all
from advisor.flight.signals.messages import Columns
from advisor.words.ascii_output import printable
from advisor.words.problems import Problem, UnusableInputError

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
        from advisor.mavlink.logs.whole import read_whole_log

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
