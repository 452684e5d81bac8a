"""Breaks in the stamps of one power-on: times in which the advisor was down, and jumps of the clock.

After a pause the link's process writes a text into its own stream. In a log and in a link, a gap while the
advisor was down is not blamed on radio or pilot.
"""

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.process.arrays import FloatArray

DOWN = b"Advisor listens again"
"""Text that the advisor writes into its own stream after it was down."""
LEAP_S = 600.0
"""Least step of the stamps that counts as a jump of the clock, s. A movement of the elevator never contains a
silence of ten minutes."""
_READ_WITHIN_S = 2.0
"""Longest time from the text to the arrival of a gap that the advisor caused, s. Packets from the socket's
queue arrive first, within milliseconds."""
_LEAST_S = 0.5
"""Least gap in the elevator's stamps that is recorded, s: two samples at 4 Hz."""

Stretch = tuple[float, float]
"""Begin and end of a stretch of vehicle time, s since boot."""


class Breaks:
    """Breaks in the stamps of the elevator and of the vehicle's clock."""

    def __init__(self) -> None:
        self._until_s = -np.inf
        self.begin()

    def begin(self) -> None:
        self._last_s = np.nan
        self._missed: list[Stretch] = []
        self._leaps: list[Stretch] = []

    def hear(self, columns: Columns) -> None:
        """Take STATUSTEXT messages."""
        for text, arrival_s in zip(columns.fields["text"].tolist(), columns.arrival_s.tolist(), strict=True):
            if bytes(text).startswith(DOWN):
                self._until_s = arrival_s + _READ_WITHIN_S

    def take(self, t: FloatArray, arrival_s: FloatArray) -> list[Stretch]:
        """Take elevator samples, and return the gaps that the advisor has caused.

        Parameters
        ----------
        t, arrival_s : shape (n,)
            Vehicle times and host times of arrival of the samples, s.
        """
        stamps = np.concatenate(([self._last_s], t))
        newest = np.fmax.accumulate(stamps)
        steps = stamps[1:] - newest[:-1]
        self._last_s = float(newest[-1])
        self.take_clock(stamps)
        rows = np.flatnonzero((steps >= _LEAST_S) & (arrival_s <= self._until_s))
        gaps = [(float(newest[row]), float(stamps[row + 1])) for row in rows]
        self._missed += gaps
        return gaps

    def take_clock(self, clock: FloatArray) -> None:
        """Take clock readings, shape (n,), s since boot; the first is the last earlier reading."""
        for row in np.flatnonzero(np.diff(clock) >= LEAP_S):
            self._leaps.append((float(clock[row]), float(clock[row + 1])))

    def missed_s(self, from_s: float, to_s: float) -> float:
        """Return the total length of the advisor's gaps that overlap a stretch of vehicle time, s."""
        return sum(_lengths(self._missed, from_s, to_s))

    def leapt_s(self, from_s: float, to_s: float) -> float:
        """Return the longest clock jump that overlaps a stretch of vehicle time, s; 0 for none."""
        return max(_lengths(self._leaps, from_s, to_s), default=0.0)


def _lengths(stretches: list[Stretch], from_s: float, to_s: float) -> list[float]:
    return [end - begin for begin, end in stretches if begin <= to_s and end >= from_s]
