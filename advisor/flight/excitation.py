"""What a movement of the elevator tells about the short period, from the pitch rate alone.

The short period makes of the elevator δ and the pitch rate q a linear recursion of second order,

    q[k] = a1·q[k−1] + a2·q[k−2] + b0·δ[k] + b1·δ[k−1] + b2·δ[k−2] + c + d·k + ε[k],

on means over intervals of equal length. A servo's lag spreads over b0, b1, b2. The statistic
F asks whether b0, b1 and b2 explain more than chance does once the aircraft's own motion is known
(Draper & Smith, Applied Regression Analysis, 1998, ch. 6). Angle of attack and acceleration are not needed.
"""

from dataclasses import dataclass
from itertools import pairwise
from math import inf, sqrt

import numpy as np

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.motion import integrated

_INPUTS = 3
"""Terms of the elevator in the recursion."""
_FEWEST = 24
"""Intervals below which the recursion with its seven terms says nothing."""
_LONGEST_S = 0.3
"""Longest interval: a fifth of the natural period of a slow aircraft at 0.5 Hz."""
_PER_STEP = 4.0
"""Intervals to the shortest step: a step is matched to the short period."""
_MANY = 40.0
"""Intervals to a record, where its sampling allows."""


@dataclass(frozen=True, slots=True)
class Excitation:
    """What the elevator did to the pitch rate."""

    pitch_rate: float
    """Half of the range of the pitch rate, rad/s."""
    relative_error: float
    """Relative standard error of the elevator's effect, one over the root of 3·F; infinite without any."""


def excitation(maneuver: Maneuver) -> Excitation | None:
    """Measure what a movement tells about the short period.

    Parameters
    ----------
    maneuver
        The record with channels ``elevator`` and ``q``.

    Returns
    -------
    Excitation or None
        None where the pitch rate is missing, never changes, or is too slow to say.
    """
    elevator, q = maneuver.channels.get("elevator"), maneuver.channels.get("q")
    if elevator is None or q is None or len(elevator) < 3 or len(q) < 3 or np.ptp(q.y) == 0.0:
        return None
    start, end = max(elevator.t[0], q.t[0]), min(elevator.t[-1], q.t[-1])
    lasting = [b - a for (a, _), (b, _) in pairwise(maneuver.span.steps)]
    coarse = 2.0 * max(float(np.median(np.diff(elevator.t))), float(np.median(np.diff(q.t))))
    wanted = min(min(lasting, default=inf) / _PER_STEP, (end - start) / _MANY, _LONGEST_S)
    edges = np.arange(start, end, max(coarse, wanted))
    if len(edges) <= _FEWEST:
        return None
    rate, moved = _means(edges, q.t, q.y), _means(edges, elevator.t, elevator.y - np.mean(elevator.y))
    pitch_rate = 0.5 * float(np.ptp(q.y))
    statistic = _f_statistic(rate, moved)
    return Excitation(pitch_rate, 1.0 / sqrt(_INPUTS * statistic) if statistic > 0.0 else inf)


def _means(edges: FloatArray, t: FloatArray, y: FloatArray) -> FloatArray:
    """Means of a signal over the intervals between the edges."""
    means: FloatArray = np.diff(np.interp(edges, t, integrated(t, y))) / np.diff(edges)
    return means


def _f_statistic(q: FloatArray, elevator: FloatArray) -> float:
    """F of the elevator's three terms in the recursion."""
    n = len(q) - 2
    own = np.column_stack([q[1:-1], q[:-2], np.ones(n), np.linspace(-1.0, 1.0, n)])
    full = np.column_stack([own, elevator[2:], elevator[1:-1], elevator[:-2]])
    without, left = _unexplained(own, q[2:]), _unexplained(full, q[2:])
    freedom = n - full.shape[1]
    return max(0.0, without - left) / _INPUTS / max(left / freedom, 1e-300)


def _unexplained(terms: FloatArray, y: FloatArray) -> float:
    """Sum of squares that least squares on these terms leaves."""
    scaled = terms / np.maximum(np.abs(terms).max(axis=0), 1e-12)
    left = y - scaled @ np.linalg.lstsq(scaled, y, rcond=None)[0]
    return float(left @ left)
