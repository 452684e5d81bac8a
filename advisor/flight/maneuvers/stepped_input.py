"""Cost of models of a control, and the piecewise constant input with the least cost."""

from dataclasses import dataclass
from itertools import pairwise
from math import inf, log

import numpy as np

from advisor.flight.maneuvers.binned import BIN_S, Bins
from advisor.flight.maneuvers.free_response import FREE_S
from advisor.flight.maneuvers.movement import BAND, is_still
from advisor.process.arrays import FloatArray, IntArray

_REMNANT = 0.02
"""Variance of the remnant over that of the movement. Each displayed quantity, angle and rate, has 1 %
(Levison, Baron & Kleinman, IEEE Transactions on Man-Machine Systems 10, 1969)."""
_EDGE_BINS = 4
"""Least distance of the first and the last step of an own input, in bins. A hand-flown edge lasts 0.2 to
0.4 s."""
_SMALL = 0.2
"""Least height of an edge of the input, over the highest edge. The first edge of a 3-2-1-1 with balanced
areas has a quarter."""
_NEW = 1e-6
"""Least part of a step's shape that earlier steps do not have already."""
_ROUNDING = 1e-8
"""Least variance of a model's residual, over that of the movement: rounding of the samples' means."""
_LEAST = 1e-16
"""Least sum of squares of a residual, rad²."""
_MOST_STEPS = 14
"""Largest number of steps of an own input: two edges for each step of a 3-2-1-1 and its return, twice."""


@dataclass(frozen=True, slots=True)
class Own:
    """An own input within a movement, and its cost."""

    nats: float
    begins_s: float
    ends_s: float


class Cost:
    """Costs of models at one correlation of the remnant, in units of likelihood."""

    def __init__(self, bins: Bins, keep: float, loop: float) -> None:
        self.bins, self._keep = bins, keep
        self.moved = self.white(bins.moved)
        size = float(np.mean(bins.moved[bins.movement] ** 2))
        self._floor = (_REMNANT * (1.0 - keep**2) + _ROUNDING) * size + _LEAST
        self.step = 1.5 * log(bins.within)
        """Cost of a step: half of log n for its size, and log n for its time."""
        self.loop = loop
        """Cost of a loop's gains, delay and take-over."""

    def white(self, y: FloatArray) -> FloatArray:
        """Return a series without the remnant's correlation, along the last axis."""
        out = y.copy()
        out[..., 1:] -= self._keep * y[..., :-1]
        return out

    def of(self, left: float) -> float:
        """Return the cost of a sum of squares over all bins, with one variance."""
        return 0.5 * self.bins.count * log(left + self._floor * self.bins.count)

    def of_each(self, left: FloatArray) -> FloatArray:
        """Return the cost of several sums of squares."""
        costs: FloatArray = 0.5 * self.bins.count * np.log(left + self._floor * self.bins.count)
        return costs

    def of_two(self, before: float, within: float) -> float:
        """Return the cost with another variance within the movement; infinite unless it is larger."""
        n, m = self.bins.within, len(self.bins.hands)
        least, larger = before / m + self._floor, within / n + self._floor
        if larger <= least:
            return inf
        count = log(self.bins.count)
        return 0.5 * (m * (log(least) + count) + n * (log(larger) + count) + log(n))


def stepped_input(cost: Cost, together: FloatArray, before: float, whole: tuple[float, float]) -> Own:
    """Return the piecewise constant input with the least cost, from the begin or after hands.

    Parameters
    ----------
    together
        Residual of the hands' loop with common gains: seconds before, then the movement.
    before
        Sum of squares of the seconds before.
    whole
        Begin and last step of the movement, s.
    """
    bins, n = cost.bins, cost.bins.within
    left, steps = _steps(cost, before)
    all_steps = cost.of(before + squares(left)) + cost.loop + cost.step * len(steps)
    order = np.sort(np.array(steps, dtype=int))
    taken = np.searchsorted(order, np.arange(n))
    hands = np.concatenate(([0.0], np.cumsum(together[len(bins.hands) :] ** 2)[:-1]))
    own = np.cumsum((left**2)[::-1])[::-1]
    left_over = squares(together[: len(bins.hands)]) + hands + own
    later = cost.of_each(left_over) + cost.loop + cost.step * (len(order) - taken) + log(n)
    # One edge is no input: hands that take over make one.
    later[np.append(order, n)[taken] + _EDGE_BINS > (order[-1] if len(order) else 0)] = inf
    best = int(np.argmin(later))
    if later[best] < all_steps:
        order = order[taken[best] :]
    if len(order) == 0:
        return Own(all_steps, *whole)
    begin, end = _extent(cost, order)
    return Own(
        min(float(later[best]), all_steps),
        whole[0] if begin == 0 else bins.begin_s(begin),
        whole[1] if end == n else bins.begin_s(end),
    )


def _extent(cost: Cost, order: IntArray) -> tuple[int, int]:
    """Return the first bin of the input that the steps form, and the bin of its last step.

    Hands before the input hold no level away from that before. Hands that rest for a free response after the
    input stay near that level. The extent is 0 to n, shape of the movement, where no hands are told apart.
    """
    n = cost.bins.within
    control = cost.bins.moved[cost.bins.movement]
    moved = np.abs(control)
    shapes = cost.white(np.triu(np.ones((n, n))))[order]
    fitted = np.linalg.lstsq(shapes.T, cost.moved[cost.bins.movement], rcond=None)
    sizes = np.asarray(fitted[0], dtype=np.float64)
    edges = np.split(np.arange(len(order)), np.flatnonzero(np.diff(order) >= _EDGE_BINS) + 1)
    heights = np.array([_height(sizes[edge]) for edge in edges])
    large = [edge for edge, high in zip(edges, heights, strict=True) if high >= _SMALL * np.max(heights)]
    near = BAND * float(np.max(moved))
    groups = [[large[0]]]
    for before, after in pairwise(large):
        rests = moved[order[before[-1]] + 1 : order[after[0]]]
        if len(rests) * BIN_S >= FREE_S[0] and float(np.median(rests)) < near:
            groups.append([])
        groups[-1].append(after)
    chosen = int(np.argmax([sum([_height(sizes[edge]) for edge in group]) for group in groups]))
    begin = int(order[groups[chosen][0][0]])
    if float(np.median(moved[: begin + 1])) >= near and is_still(control[:begin], float(np.max(moved))):
        begin = 0  # The first level of the input.
    last = n if chosen == len(groups) - 1 else int(order[groups[chosen][-1][-1]])
    return begin, last


def _height(steps: FloatArray) -> float:
    """Return the height of an edge that is made of steps, rad."""
    return float(np.max(np.abs(np.cumsum(steps))))


def _steps(cost: Cost, before: float) -> tuple[FloatArray, list[int]]:
    """Return the movement's residual after its steps, and the steps' bins: one after another while each pays.

    Parameters
    ----------
    before
        Sum of squares of the seconds before.
    """
    n = cost.bins.within
    shapes = cost.white(np.triu(np.ones((n, n))))
    moved = cost.moved[cost.bins.movement]
    left, steps = moved, list[int]()
    while len(steps) < min(_MOST_STEPS, n - 1):
        basis, _ = np.linalg.qr(shapes[steps].T)
        new = shapes - (shapes @ basis) @ basis.T
        size = np.einsum("ij,ij->i", new, new)
        gain = np.where(size > _NEW, (new @ left) ** 2 / np.maximum(size, _NEW), 0.0)
        k = int(np.argmax(gain))
        now = squares(left)
        if cost.of(before + now) - cost.of(before + now - float(gain[k])) < cost.step:
            break
        steps.append(k)
        basis, _ = np.linalg.qr(shapes[steps].T)
        left = moved - basis @ (basis.T @ moved)
    return left, steps


def squares(y: FloatArray) -> float:
    """Return the sum of squares of a series."""
    return float(y @ y)
