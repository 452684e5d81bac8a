"""Messages of one vehicle by boot, with the master clock of each boot."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from advisor.flight.signals.clocks import BootClock
from advisor.flight.signals.messages import Columns, FloatArray, IntArray
from advisor.flight.vehicle.pieces import between


@dataclass(frozen=True, slots=True)
class Master:
    """The master clock of one boot."""

    boot: int
    """Number of the boot, 0 for the first."""
    order: IntArray
    """Order of arrival, among all messages, of each accepted stamp, shape (n,)."""
    t: FloatArray
    """Accepted stamps, shape (n,), s since boot."""


def by_boot(
    columns: Sequence[Columns], component: int, clock: BootClock, boot: int
) -> Iterator[tuple[list[Columns], Master]]:
    """Yield the columns of a vehicle, divided where the vehicle restarted (nearly always: nowhere).

    Parameters
    ----------
    component
        Component id of the autopilot, whose ``ATTITUDE`` is the master clock.
    clock
        Clock, which the stamps in ``columns`` advance.
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
        yield between(columns, a, b) if len(boots) > 1 else list(columns), master
