"""Drawing a line of many samples with few points, so that the file shrinks and the picture stays."""

from itertools import pairwise

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.record import Channel


def thinned(channel: Channel, bins: int) -> tuple[FloatArray, FloatArray]:
    """Return times and values that draw an equal line: lowest and highest of each bin, and a break in each
    gap.

    Parameters
    ----------
    bins
        Stretches of equal numbers of samples.
    """
    t, y = channel.t, channel.y
    if len(t) > 2 * bins:
        edges = np.linspace(0, len(t), bins + 1).astype(int)
        kept = sorted({i for a, b in pairwise(edges) for i in _extremes(y[a:b], int(a))})
        t, y = t[kept], y[kept]
    gaps = np.flatnonzero(np.diff(t) > max(2.0, 20.0 * float(np.median(np.diff(t))) if len(t) > 1 else 2.0))
    return np.insert(t, gaps + 1, t[gaps]), np.insert(y, gaps + 1, np.nan)


def _extremes(y: FloatArray, offset: int) -> tuple[int, int]:
    return offset + int(np.argmin(y)), offset + int(np.argmax(y))
