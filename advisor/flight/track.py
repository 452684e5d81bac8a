"""A track: the samples of one channel from one source, as they arrive, with bounded memory."""

from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.channels import DERIVED_ALPHA, GIVEN_AIRSPEED, READINGS, Decoded
from advisor.flight.messages import FloatArray, IntArray
from advisor.flight.record import UNITS, Channel


@dataclass(frozen=True, slots=True)
class ChannelStatus:
    """How one channel arrives."""

    source: str
    provenance: str
    rate_hz: float
    """Samples per second over the newest ten seconds of the channel."""
    largest_gap_s: float
    """Longest time between two stamps since boot."""
    last_s: float
    """Vehicle time of the newest sample."""


class Track:
    """Grows at its end, forgets its beginning.

    Late packets are kept and sorted in when a stretch is cut; duplicates are dropped there.
    """

    def __init__(self, name: str, source: str, provenance: str) -> None:
        self.name = name
        self.source = source
        self.provenance = provenance
        self.newest_s = -np.inf
        self.largest_gap_s = 0.0
        self._t = np.empty(1024)
        self._y = np.empty(1024)
        self._order = np.empty(1024, dtype=np.int64)
        self._size = 0
        self._keep_from_s = -np.inf

    def append(self, t: FloatArray, y: FloatArray, order: IntArray) -> None:
        """Take samples in order of arrival."""
        if len(t) == 0:
            return
        before = self.newest_s if self._size else float(t[0])
        newest = np.maximum.accumulate(np.concatenate(([before], t)))
        self.largest_gap_s = max(self.largest_gap_s, float((newest[1:] - newest[:-1]).max()))
        self.newest_s = float(newest[-1])
        self._make_room(len(t))
        new = slice(self._size, self._size + len(t))
        self._t[new], self._y[new], self._order[new] = t, y, order
        self._size = new.stop

    def forget(self, before_s: float) -> None:
        """Let go of samples older than this when room is needed."""
        self._keep_from_s = before_s

    def cut(self, start_s: float, end_s: float, up_to_order: int | None = None) -> Channel:
        """The samples with ``start_s <= t <= end_s`` that had arrived by ``up_to_order``."""
        t, y = self._t[: self._size], self._y[: self._size]
        wanted = (t >= start_s) & (t <= end_s)
        if up_to_order is not None:
            wanted &= self._order[: self._size] <= up_to_order
        t, y = t[wanted], y[wanted]
        t, first = np.unique(t, return_index=True)
        return Channel(self.name, t, y[first], self.source, self.provenance)

    @property
    def status(self) -> ChannelStatus:
        """How it arrives."""
        recent = self.cut(self.newest_s - 10.0, self.newest_s)
        gap = self.largest_gap_s if self._size > 1 else float("inf")
        span = float(recent.t[-1] - recent.t[0]) if len(recent) > 1 else 0.0
        rate = (len(recent) - 1) / span if span > 0.0 else float("nan")
        return ChannelStatus(self.source, self.provenance, rate, gap, self.newest_s)

    def _make_room(self, n: int) -> None:
        if self._size + n <= len(self._t):
            return
        kept = self._t[: self._size] >= self._keep_from_s
        size = int(np.count_nonzero(kept))
        capacity = max(1024, 2 * (size + n))
        for name in ("_t", "_y", "_order"):
            old = getattr(self, name)
            grown = np.empty(capacity, dtype=old.dtype)
            grown[:size] = old[: self._size][kept]
            setattr(self, name, grown)
        self._size = size


class Tracks:
    """All tracks of one vehicle, and which source speaks for a channel.

    Parameters
    ----------
    alpha_source
        ``auto``, ``aoa_ssa``, ``derived``, ``named_value:NAME`` or ``none``, as the aircraft file has it.
        With ``none`` the channel is kept as with ``auto``, but no estimate uses it.
    """

    def __init__(self, alpha_source: str) -> None:
        self._tracks: dict[tuple[str, str], Track] = {}
        self._sources: dict[str, list[str]] = {}
        for reading in READINGS:
            self._sources.setdefault(reading.channel, []).append(reading.source)
        self._sources["airspeed"].append(GIVEN_AIRSPEED)
        named = alpha_source.removeprefix("named_value:")
        self._sources["alpha"] = {
            "auto": ["AOA_SSA.AOA", DERIVED_ALPHA],
            "none": ["AOA_SSA.AOA", DERIVED_ALPHA],
            "aoa_ssa": ["AOA_SSA.AOA"],
            "derived": [DERIVED_ALPHA],
        }.get(alpha_source, [f"NAMED_VALUE_FLOAT.{named}"])

    def clear(self) -> None:
        """Forget everything: another boot."""
        self._tracks.clear()

    def forget(self, before_s: float) -> None:
        """Let go of what is older, when room is needed."""
        for track in self._tracks.values():
            track.forget(before_s)

    def append(self, new: Decoded) -> None:
        """Take samples of one channel from one source."""
        key = (new.channel, new.source)
        if len(new.t) == 0:
            return
        if key not in self._tracks:
            self._tracks[key] = Track(new.channel, new.source, new.provenance)
        self._tracks[key].append(new.t, new.y, new.order)

    def cut(self, name: str, start_s: float, end_s: float, up_to_order: int | None = None) -> Channel | None:
        """A stretch of a channel from its best source that says anything there; None without one."""
        spare = None
        for track in self._candidates(name):
            channel = track.cut(start_s, end_s, up_to_order)
            if len(channel) < 2:
                continue
            if name != "alpha" or np.ptp(channel.y) > 0.0:
                return _in_radians(channel)
            spare = spare or channel
        return spare

    def recent(self, name: str, seconds: float) -> Channel | None:
        """The newest stretch of a channel; None when nothing of it has arrived."""
        newest = max((track.newest_s for track in self._candidates(name)), default=None)
        return None if newest is None else self.cut(name, newest - seconds, newest)

    def statuses(self) -> dict[str, ChannelStatus]:
        """How every channel arrives, from its best source."""
        found = {name: next(iter(self._candidates(name)), None) for name in UNITS}
        return {name: track.status for name, track in found.items() if track is not None}

    def _candidates(self, name: str) -> list[Track]:
        """Tracks of a channel, the preferred source first."""
        preferred = self._sources.get(name)
        if preferred is None:
            return [track for (channel, _), track in self._tracks.items() if channel == name]
        return [self._tracks[name, source] for source in preferred if (name, source) in self._tracks]


_LARGEST_ALPHA_RAD = 0.7
"""Nobody flies a short period at 40 degrees: a named value beyond this is in degrees."""


def _in_radians(channel: Channel) -> Channel:
    """A vane's named value carries no unit: degrees and radians are told apart by their size."""
    if not channel.source.startswith("NAMED_VALUE_FLOAT") or np.max(np.abs(channel.y)) <= _LARGEST_ALPHA_RAD:
        return channel
    return replace(channel, y=np.radians(channel.y))
