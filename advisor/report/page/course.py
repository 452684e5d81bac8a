"""Time histories of whole flights: a few channels from take-off to landing, for a picture."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import ceil

import numpy as np

from advisor.campaign.campaign import Campaign
from advisor.flight.messages import Columns, FloatArray, cut
from advisor.flight.record import Channel

SHOWN = ("elevator", "alpha", "q", "airspeed", "height")
_SLICE_S = 40.0
_LOOK_BACK_S = 100.0
"""Length of each look back, s. Shorter than the stream keeps and longer than a slice, so that nothing is
missed."""


@dataclass(frozen=True, slots=True)
class Course:
    """Channels of one power-on in one log."""

    flight: int
    boot: int
    channels: tuple[Channel, ...]


def slices(columns: Sequence[Columns]) -> Iterator[list[Columns]]:
    """Cut a batch in its order of arrival into pieces of some forty seconds."""
    filled = [c for c in columns if len(c)]
    if not filled:
        return
    span_s = max(c.arrival_s.max() for c in filled) - min(c.arrival_s.min() for c in filled)
    pieces = min(max(1, ceil(span_s / _SLICE_S)), 1 + max(map(len, filled)))
    orders = np.sort(np.concatenate([c.order for c in filled]))
    edges = orders[np.linspace(0, len(orders) - 1, pieces + 1).astype(int)]
    edges[-1] += 1
    for first, end in pairwise(edges):
        piece = [cut(c, slice(*np.searchsorted(c.order, [first, end]))) for c in filled]
        yield [c for c in piece if len(c)]


class CourseWatch:
    """Collects channels that a campaign drops, by a look after every piece of a log.

    Parameters
    ----------
    campaign
        Campaign that takes the logs.
    """

    def __init__(self, campaign: Campaign) -> None:
        self._campaign = campaign
        self._parts: dict[tuple[int, int], dict[str, list[Channel]]] = {}

    def look(self) -> None:
        """Take the samples since the last look."""
        at = self._campaign.power_on
        for name in SHOWN:
            recent = self._campaign.recent(name, _LOOK_BACK_S)
            if recent is None or len(recent) == 0:
                continue
            parts = self._parts.setdefault(at, {}).setdefault(name, [])
            after_s = parts[-1].t[-1] if parts else -np.inf
            new = recent.cut(float(np.nextafter(after_s, np.inf)), np.inf)
            if len(new):
                parts.append(new)

    @property
    def courses(self) -> tuple[Course, ...]:
        """Collected channels, flight by flight."""
        return tuple(
            Course(flight, boot, tuple(_joined(parts) for parts in channels.values()))
            for (flight, boot), channels in sorted(self._parts.items())
        )


def _joined(parts: Sequence[Channel]) -> Channel:
    last = parts[-1]
    t, y = (np.concatenate([getattr(part, which) for part in parts]) for which in ("t", "y"))
    return Channel(last.name, t, y, last.source, last.provenance)


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
