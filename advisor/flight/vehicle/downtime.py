"""Times in which nobody listened, because a process of the advisor was down or stood still.

The process of the link writes a text into its own stream when it listens again. So a log and a link agree on
who is to blame for a gap: the advisor, and neither the radio nor the pilot.
"""

import numpy as np

from advisor.flight.signals.messages import Columns, FloatArray

DOWN = b"Advisor listens again"
"""Text that the advisor writes into its own stream after it was down."""
_READ_WITHIN_S = 2.0
"""Time of arrival after the text, s, within which a gap of the stamps belongs to it. Packets that have waited
in the socket come first, within milliseconds."""
_LEAST_S = 0.5
"""Least gap of the elevator's stamps that counts, s: two samples of the slowest usable stream of 4 Hz."""


class Downtime:
    """Gaps in the stamps of one power-on that the advisor itself has caused."""

    def __init__(self) -> None:
        self._until_s = -np.inf
        self.begin()

    def begin(self) -> None:
        """Begin another power-on."""
        self._last_s = np.nan
        self._missed: list[tuple[float, float]] = []

    def hear(self, columns: Columns) -> None:
        """Take STATUSTEXT messages."""
        for text, arrival_s in zip(columns.fields["text"].tolist(), columns.arrival_s.tolist(), strict=True):
            if bytes(text).startswith(DOWN):
                self._until_s = arrival_s + _READ_WITHIN_S

    def take(self, t: FloatArray, arrival_s: FloatArray) -> list[tuple[float, float]]:
        """Take samples of the elevator; return the gaps that the advisor has caused, begin and end in s.

        Parameters
        ----------
        t, arrival_s : shape (n,)
            Vehicle times and host times of arrival, s.
        """
        found: list[tuple[float, float]] = []
        if arrival_s.size and arrival_s[0] > self._until_s:
            self._last_s = np.fmax(self._last_s, np.fmax.reduce(t))
            return found
        for now_s, at_s in zip(t.tolist(), arrival_s.tolist(), strict=True):
            if now_s - self._last_s >= _LEAST_S and at_s <= self._until_s:
                found.append((self._last_s, now_s))
            self._last_s = np.fmax(now_s, self._last_s)
        self._missed += found
        return found

    def missed_s(self, from_s: float, to_s: float) -> float:
        """Return the length of the gaps that touch a stretch of vehicle time, s."""
        return sum(end - begin for begin, end in self._missed if begin <= to_s and end >= from_s)
