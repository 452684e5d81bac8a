"""Jumps of the command: where between two stamps they happened, and which stamps were lost on the way."""

import numpy as np

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray

_STEEP, _SHORT_S = 0.15, 0.02
"""Share of the command's range by which it must jump between two stamps no further apart than this; where
they are, what matters is the jump times the interval."""
_LOST = 1.5
"""Intervals of the usual length from which on a stamp was lost."""
_HOLE_S, _HOLE = 0.15, 3.5
"""A hole of the command's log: this long, and so many of its usual intervals."""
_PULSE_S = 0.25
"""A hole in which a pulse may have come and gone: those of a fast short period are no longer."""


def edges_of(t: FloatArray, u: FloatArray) -> FloatArray:
    """Shape (m, 4), as ``Flight.edges``: where between two stamps a jump happened is not in the log.

    ``t`` and ``u`` are the command's stamps and values, both shape (n,).
    """
    jump = np.diff(u)
    size = np.ptp(u)
    if size <= 0.0:
        return np.empty((0, 4))
    # A jump may be spread over two intervals; each is uncertain by its own length.
    interval = np.diff(t)
    least = _STEEP * size * min(float(np.median(interval)), _SHORT_S)
    steep = np.flatnonzero(np.abs(jump) * interval > least)
    interval = interval[steep]
    middle = (t[steep] + t[steep + 1]) / 2.0
    return np.column_stack([middle, jump[steep] * interval, interval, _lost(t)[steep]])


def held_from(t: FloatArray) -> FloatArray:
    """From when on each value was held, shape (n,): its stamp, or the middle of those that were lost."""
    return np.asarray(t - np.append(0.0, 0.5 * _lost(t)))


def step_unseen(maneuver: Maneuver) -> bool:
    """Whether the command changed, or may have, while so many of its stamps were lost that nobody knows when.

    Between the first and the last step a whole pulse may lie in a hole: before and after it the command is
    the same.
    """
    t, span = maneuver.channels["elevator"].t, maneuver.span
    interval = np.diff(t)
    edges = edges_of(t, maneuver.channels["elevator"].y)
    hole = max(_HOLE_S, _HOLE * float(np.median(interval)))
    active = interval[(t[1:] > span.start_s) & (t[:-1] < span.last_step_s)]
    changed, longest = np.max(edges[:, 2], initial=0.0), np.max(active, initial=0.0)
    return bool(changed > hole or longest > max(hole, _PULSE_S))


def _lost(t: FloatArray) -> FloatArray:
    """Shape (n - 1,): by how much each interval between stamps is longer than usual, if a stamp was lost."""
    interval = np.diff(t)
    usual = float(np.median(interval))
    return np.where(interval > _LOST * usual, interval - usual, 0.0)
