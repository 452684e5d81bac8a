"""Search along one coordinate after another, for costs without slopes."""

from collections.abc import Callable, Sequence

from advisor.process.arrays import FloatArray

_GAIN = 0.5
"""Least decrease of a cost that counts, nats."""


def coordinate_search(
    cost: Callable[[FloatArray], float], x: FloatArray, free: Sequence[int], steps: Sequence[float]
) -> tuple[FloatArray, float]:
    """Return the least point, shape (n,), and its cost in nats, from a start ``x``.

    The ``free`` coordinates move by decreasing ``steps``.
    """
    best = cost(x)
    for step in steps:
        for i in free:
            for direction in (step, -step):
                before = best
                while True:
                    moved = x.copy()
                    moved[i] += direction
                    tried = cost(moved)
                    if not tried < best - _GAIN:
                        break
                    best, x = tried, moved
                if best < before:
                    # The opposite direction leads back to the previous point.
                    break
    return x, best
