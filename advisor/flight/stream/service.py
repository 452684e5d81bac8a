"""Present usability of the stream, judged from the newest stretch by times of arrival.

A stream that was usable at the first manoeuvre may become too slow, or lose its elevator. Times of arrival
are used, because the vehicle's clock stops when ATTITUDE stops. Judgements happen at fixed steps of arrival,
so a log and a live link agree for any batches. The link's own watch reports a wholly silent link.
"""

from array import array
from collections.abc import Callable, Mapping, Sequence
from math import nan

import numpy as np

from advisor.flight.maneuvers.events import DataAgain, NoData
from advisor.flight.signals.messages import Columns
from advisor.flight.signals.track import ChannelStatus
from advisor.process.arrays import FloatArray
from advisor.words.problems import Problem

WINDOW_S = 3.0
"""Length over which rates are counted, s: two dozen samples at the slowest allowed rate."""
STEP_S = 0.5
"""Time of arrival between two judgements, s."""
LAPSED_AFTER_S = 1.0
"""Time for which a problem must persist before its report, s. With ``WINDOW_S`` the report comes within 5
s."""
SERVED_AFTER_S = 5.0
"""Time without any problem before the problem's end is reported, s."""
PAUSE_S = 2.5
"""Silence of the vehicle after which counting restarts, s: two heartbeat intervals."""

Judge = Callable[[Mapping[str, ChannelStatus], float], Sequence[Problem]]


class Service:
    """Watch of the arriving messages, which reports when they become unusable and usable again.

    Parameters
    ----------
    judge
        Function that returns the problems of a stream with these recent channels, at a time of arrival, s.
    """

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._arrivals: dict[tuple[str, str], array[float]] = {}
        self._clock: list[tuple[float, float]] = []
        self._newest_s = -np.inf
        self._due_s = np.inf
        self._since_s: float | None = None
        self._standing: frozenset[str] = frozenset()
        self.problems: tuple[Problem, ...] = ()
        """Reasons why the stream cannot be used now; empty for a usable stream, or before the first
        judgement.
        """
        self.serves = False
        """Whether the newest judgement found no problem, and no problem is reported. False before the first
        judgement."""

    def begin(self) -> None:
        """Begin another vehicle or another power-on, and forget the earlier messages."""
        self._arrivals.clear()
        self._clock.clear()
        self._newest_s = -np.inf

    def end(self) -> None:
        """End the watch, because no further message comes or is wanted."""
        self.problems = ()

    def take(self, channel: str, source: str, arrival_s: FloatArray) -> None:
        """Take the times of arrival, shape (n,), of a channel's samples from one source."""
        times = self._arrivals.setdefault((channel, source), array("d"))
        times.frombytes(np.asarray(arrival_s, float).tobytes())

    def take_clock(self, arrival_s: FloatArray, vehicle_s: FloatArray) -> None:
        """Take the vehicle's clock, s since boot, at times of arrival, s; both of shape (n,)."""
        self._clock.extend(zip(arrival_s.tolist(), vehicle_s.tolist(), strict=True))

    def advance(self, columns: Sequence[Columns]) -> list[NoData | DataAgain]:
        """Judge the stream at every step of arrival that these messages have passed."""
        if not columns:
            return []
        newest_s = max(float(c.arrival_s[-1]) for c in columns)
        if newest_s < min(self._due_s, self._newest_s + PAUSE_S):
            # As nearly always: no moment of judgement has passed.
            self._newest_s = max(self._newest_s, newest_s)
            return []
        news: list[NoData | DataAgain] = []
        for now_s in np.unique(np.concatenate([c.arrival_s for c in columns])).tolist():
            if now_s > self._newest_s + PAUSE_S:
                self._due_s = now_s + WINDOW_S
                self._since_s = None
            while self._due_s <= now_s:
                news += self._look(self._due_s)
                self._due_s += STEP_S
            self._newest_s = max(self._newest_s, now_s)
        self._forget()
        return news

    def _forget(self) -> None:
        """Drop times of arrival that no later judgement needs."""
        oldest_s = self._newest_s - WINDOW_S - STEP_S
        for times in self._arrivals.values():
            needed = np.flatnonzero(np.array(times) > oldest_s)
            del times[: int(needed[0]) if len(needed) else len(times)]
        # The newest reading stays, however long ago the clock stopped.
        del self._clock[: sum(arrival_s <= oldest_s for arrival_s, _ in self._clock[:-1])]

    def _look(self, now_s: float) -> list[NoData | DataAgain]:
        problems = tuple(self._judge(self._lately(now_s), now_s))
        standing = frozenset(problem.code for problem in problems)
        if standing != self._standing or self._since_s is None:
            self._standing, self._since_s = standing, now_s
        stood_s = now_s - self._since_s
        reported = {problem.code for problem in self.problems}
        self.serves = not problems and not reported
        if reported and not problems and stood_s >= SERVED_AFTER_S:
            self.problems, self.serves = (), True
            return [DataAgain(self._vehicle_s(now_s))]
        if standing == reported or not problems or stood_s < LAPSED_AFTER_S:
            return []
        self.problems = problems
        return [] if standing < reported else [NoData(problems, self._vehicle_s(now_s))]

    def _vehicle_s(self, now_s: float) -> float:
        """Return the vehicle's clock at a time of arrival, s; NaN before its first reading."""
        return max((t for arrival_s, t in self._clock if arrival_s <= now_s), default=nan)

    def _lately(self, now_s: float) -> dict[str, ChannelStatus]:
        """Return the arrival status of every channel within the window, from its fastest source."""
        statuses: dict[str, ChannelStatus] = {}
        for (channel, source), times in self._arrivals.items():
            heard = np.array(times)
            newest = heard[(heard > now_s - WINDOW_S) & (heard <= now_s)]
            rate_hz = len(newest) / WINDOW_S
            if len(newest) and (channel not in statuses or rate_hz > statuses[channel].rate_hz):
                statuses[channel] = ChannelStatus(source, "", rate_hz, WINDOW_S, float(newest[-1]))
        return statuses
