"""Lobes of a signal on either side of a level: where they begin, when they step, how square they are."""

from itertools import pairwise

import numpy as np

from advisor.flight.messages import FloatArray


def without_spikes(u: FloatArray) -> FloatArray:
    """Median of three: one sample alone is no movement."""
    if len(u) < 3:
        return u
    low, high = np.minimum(u[:-2], u[1:-1]), np.maximum(u[:-2], u[1:-1])
    return np.concatenate(([u[0]], np.maximum(low, np.minimum(high, u[2:])), [u[-1]]))


def lobes(d: FloatArray, first: int, last: int, least: float) -> list[tuple[int, int]]:
    """Stretches on one side of trim, as index pairs; short dips inside one are overlooked."""
    out = np.flatnonzero(np.abs(d[first : last + 1]) > least) + first
    above = d[out] > 0.0
    turns = np.flatnonzero(above[1:] != above[:-1])
    starts = [int(out[0]), *(int(out[k + 1]) for k in turns)]
    ends = [*(int(out[k]) for k in turns), int(out[-1])]
    return list(zip(starts, ends, strict=True))


def onsets(t: FloatArray, d: FloatArray, places: list[tuple[int, int]], levels: FloatArray) -> FloatArray:
    """Times of the steps, each where the elevator passes the middle between two levels."""
    around = np.concatenate(([0.0], levels, [0.0]))
    times = []
    for k, (old, new) in enumerate(pairwise(around)):
        if k < len(places):
            i = places[k][0]
            back = places[k - 1][1] if k else max(0, i - 1)
        else:
            back = places[-1][1]
            i = min(back + 1, len(d) - 1)
        middle = 0.5 * (old + new)
        passed = np.flatnonzero((d[back : i + 1] - middle) * np.sign(new - old) >= 0.0)
        j = back + int(passed[0]) if len(passed) else i
        times.append(0.5 * (t[j] + t[max(j - 1, 0)]))
    return np.array(times)


def squareness(t: FloatArray, d: FloatArray, levels: FloatArray, at: FloatArray, quiet: float) -> float:
    """Share of the samples between the first and the last step that lie on their lobe's level."""
    edges = np.searchsorted(t, at)
    on = 0
    for level, i, j in zip(levels, edges, edges[1:], strict=False):
        on += int(np.count_nonzero(np.abs(d[i:j] - level) <= 0.12 * abs(level) + 2.0 * quiet))
    return on / max(1, int(edges[-1] - edges[0]))
