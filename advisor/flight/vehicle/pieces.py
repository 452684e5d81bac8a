"""Messages of one vehicle, divided at changes that affect all later messages, at breaks of the link, and by
boot.

After a pause the link's process writes a text into its own stream. In a log and in a link, a gap while the
advisor was down is not blamed on radio or pilot.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from advisor.flight.signals.clocks import BootClock
from advisor.flight.signals.messages import Columns, cut
from advisor.flight.vehicle.parameters import names_in, tells_of_outputs
from advisor.process.arrays import FloatArray, IntArray

_EVERY = 100_000
"""Longest piece in arrival orders (bytes of a log), which bounds the memory for any batch."""

_STATES = {"HEARTBEAT": "custom_mode", "EXTENDED_SYS_STATE": "vtol_state"}
"""Field with the state for each message that repeats a state."""


def pieces(columns: Sequence[Columns], by_second: bool = False) -> Iterator[list[Columns]]:
    """Yield the batch in order of arrival, divided before every change of vehicle, mode or parameter.

    Parameters
    ----------
    by_second
        Whether the batch is also divided at each second of arrival, for the comparison of vehicles.
    """
    filled = [c for c in columns if len(c)]
    if not filled:
        return
    first = min(int(c.order[0]) for c in filled)
    past = max(int(c.order[-1]) for c in filled) + 1
    cuts = {first, past, *range(first, past, _EVERY)}
    for c in filled:
        cuts.update(_turning_points(c))
    if by_second:
        cuts.update(_seconds(filled))
    edges = sorted(cuts)
    for a, b in pairwise(edges):
        yield rows_between(filled, a, b)


def _seconds(columns: Sequence[Columns]) -> list[int]:
    """Return the arrival orders of the messages that begin a second of arrival."""
    order = np.concatenate([c.order for c in columns])
    rows = np.argsort(order)
    second = np.floor(np.concatenate([c.arrival_s for c in columns])[rows])
    begins = np.concatenate(([False], np.diff(np.maximum.accumulate(second)) > 0))
    return [int(n) for n in order[rows][begins]]


def rows_between(columns: Sequence[Columns], first: int, past: int) -> list[Columns]:
    """Return the rows with ``first <= order < past``, without message types that have no such row."""
    ends = ((c, np.searchsorted(c.order, [first, past]).tolist()) for c in columns)
    return [cut(c, slice(i, j)) for c, (i, j) in ends if j > i]


def _turning_points(c: Columns) -> list[int]:
    if c.name in _STATES:
        state = np.asarray(c.fields[_STATES[c.name]], dtype=np.int64)
        changed = np.concatenate(([True], state[1:] != state[:-1]))
        return [int(n) for n in c.order[changed]]
    if c.name == "PARAM_VALUE":
        telling = [tells_of_outputs(name) for name in names_in(c)]
        return [int(n) for n in c.order[np.array(telling, dtype=bool)]]
    if c.name in ("STATUSTEXT", "AUTOPILOT_VERSION"):
        return [int(n) for n in c.order]
    return []


@dataclass(frozen=True, slots=True)
class Master:
    """The master clock of one boot."""

    boot: int
    """Number of the boot, 0 for the first."""
    order: IntArray
    """Shape (n,): order of arrival of each accepted stamp, among all messages."""
    t: FloatArray
    """Shape (n,): accepted stamps, s since boot."""


def by_boot(
    columns: Sequence[Columns], component: int, clock: BootClock, boot: int
) -> Iterator[tuple[list[Columns], Master]]:
    """Yield the columns of a vehicle, divided where the vehicle restarted.

    Parameters
    ----------
    component
        Component id of the autopilot, whose ``ATTITUDE`` is the master clock.
    boot
        Number of the present boot, to which messages before the first stamp belong.
    """
    attitude = next((c for c in columns if c.name == "ATTITUDE" and c.component == component), None)
    if attitude is None:
        yield list(columns), Master(boot, np.empty(0, dtype=np.int64), np.empty(0))
        return
    ticks = clock.advance(np.asarray(attitude.fields["time_boot_ms"], dtype=np.int64))
    boots, first = np.unique(ticks.boot, return_index=True)
    edges = [int(n) for n in attitude.order[first]]
    if boots[0] == boot:
        edges[0] = 0
    else:
        boots, edges = np.concatenate(([boot], boots)), [0, *edges]
    edges.append(int(max(c.order[-1] for c in columns)) + 1)
    for number, (a, b) in zip(boots.tolist(), pairwise(edges), strict=True):
        believed = (ticks.boot == number) & np.isfinite(ticks.t)
        master = Master(number, attitude.order[believed], ticks.t[believed])
        yield rows_between(columns, a, b) if len(boots) > 1 else list(columns), master


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
