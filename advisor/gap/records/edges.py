"""Jumps of the command between two stamps, and the stamps that were lost."""

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.oem.lost_input import LOST_INTERVAL

_STEEP, _SHORT_S = 0.15, 0.02
"""Record: least jump between two stamps that counts as an edge, as a share of the command's range. The share
holds for intervals of the second number, s; for others the product of jump and interval is compared."""
_HOLE_S, _HOLE = 0.15, 3.5
"""Record: least length of a hole in the command's log, in s, and in usual intervals. A longer of the two
counts."""
_PULSE_S = 0.25
"""Record: length in s of a hole that may hide a whole pulse. Pulses for a fast short period are shorter."""


def edges_of(t: FloatArray, u: FloatArray) -> FloatArray:
    """Return the edges of the command, shape (m, 4), with the columns of ``Flight.edges``.

    ``t`` and ``u`` are the command's stamps and values, both shape (n,).
    """
    jump = np.diff(u)
    size = np.ptp(u)
    if size <= 0.0:
        return np.empty((0, 4))
    # A jump may spread over two intervals; each has the uncertainty of its own length.
    interval = np.diff(t)
    least = _STEEP * size * min(float(np.median(interval)), _SHORT_S)
    steep = np.flatnonzero(np.abs(jump) * interval > least)
    interval = interval[steep]
    middle = (t[steep] + t[steep + 1]) / 2.0
    return np.column_stack([middle, jump[steep] * interval, interval, _lost(t)[steep]])


def held_from(t: FloatArray) -> FloatArray:
    """Return the time after which each value was held, shape (n,): its stamp, or the middle of the lost
    stamps."""
    return np.asarray(t - np.append(0.0, 0.5 * _lost(t)))


def step_unseen(maneuver: Maneuver) -> bool:
    """Return whether a step of the command may lie in a hole of the log, so that its time is unknown.

    A whole pulse may lie in a hole between the first and the last step: the command is equal before and
    after.
    """
    t, span = maneuver.channels["elevator"].t, maneuver.span
    interval = np.diff(t)
    edges = edges_of(t, maneuver.channels["elevator"].y)
    hole = max(_HOLE_S, _HOLE * float(np.median(interval)))
    active = interval[(t[1:] > span.start_s) & (t[:-1] < span.last_step_s)]
    changed, longest = np.max(edges[:, 2], initial=0.0), np.max(active, initial=0.0)
    return bool(changed > hole or longest > max(hole, _PULSE_S))


def _lost(t: FloatArray) -> FloatArray:
    """Return by how much each interval exceeds the usual one where a stamp was lost, else 0, shape (n -
    1,)."""
    interval = np.diff(t)
    usual = float(np.median(interval))
    return np.where(interval > LOST_INTERVAL * usual, interval - usual, 0.0)
