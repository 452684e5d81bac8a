"""Messages of one vehicle, divided at changes that affect all later messages, and by boot."""

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
