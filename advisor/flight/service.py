"""Whether the stream can serve at this moment: its newest stretch, judged by the times of arrival.

A stream that served at the first manoeuvre may become too slow, or lose its elevator, at any time. The
times of arrival tell, for the vehicle's clock stands still when ATTITUDE stops. Moments of judgement lie at
fixed steps of arrival, so that a log and a live link tell the same, however their messages are batched.
A link that is silent altogether tells nothing of what it carries; the link itself reports a silence.
"""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from advisor.flight.events import DataAgain, NoData
from advisor.flight.messages import Columns, FloatArray
from advisor.flight.track import ChannelStatus
from advisor.problems import Problem

WINDOW_S = 3.0
"""Stretch over which rates are counted, s: two dozen samples of a channel at the slowest rate allowed."""
STEP_S = 0.5
"""Time between two judgements, s."""
LAPSED_AFTER_S = 1.0
"""A problem must stand so long before it is told, s. With ``WINDOW_S`` it is told within 5 s."""
SERVED_AFTER_S = 5.0
"""Every problem must be away so long before that is told, s: a rate about its limit is not told in turns."""
PAUSE_S = 2.5
"""Silence of the vehicle after which counting begins anew, s: two heartbeats, one of them lost."""

Judge = Callable[[Mapping[str, ChannelStatus], float], Sequence[Problem]]


class Service:
    """Watches what arrives, and tells when it cannot serve and when it can again.

    Parameters
    ----------
    judge
        What keeps a stream with these channels, as they arrived lately, from being used at this time of
        arrival, s.
    """

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._arrivals: dict[tuple[str, str], list[float]] = {}
        self._newest_s = -np.inf
        self._due_s = np.inf
        self._since_s: float | None = None
        self._standing: frozenset[str] = frozenset()
        self.problems: tuple[Problem, ...] = ()
        """Why the stream cannot serve now; empty when it can, or is not yet known."""

    def begin(self) -> None:
        """Another vehicle or another power-on: what arrived before says nothing of it."""
        self._arrivals.clear()
        self._newest_s = -np.inf

    def end(self) -> None:
        """Nothing more will come, and nothing is wanted any more."""
        self.problems = ()

    def take(self, channel: str, source: str, arrival_s: FloatArray) -> None:
        """Samples of a channel from one source arrived at these times, shape (n,)."""
        self._arrivals.setdefault((channel, source), []).extend(arrival_s.tolist())

    def advance(self, columns: Sequence[Columns]) -> list[NoData | DataAgain]:
        """Judge every moment that these messages, whatever they carry, have passed."""
        if not columns:
            return []
        newest_s = max(float(c.arrival_s[-1]) for c in columns)
        if newest_s < min(self._due_s, self._newest_s + PAUSE_S):
            # As nearly always: no moment of judgement has passed.
            self._newest_s = max(self._newest_s, newest_s)
            return []
        told: list[NoData | DataAgain] = []
        for now_s in np.unique(np.concatenate([c.arrival_s for c in columns])).tolist():
            if now_s > self._newest_s + PAUSE_S:
                self._due_s = now_s + WINDOW_S
                self._since_s = None
            while self._due_s <= now_s:
                told += self._look(self._due_s)
                self._due_s += STEP_S
            self._newest_s = max(self._newest_s, now_s)
        self._forget()
        return told

    def _forget(self) -> None:
        """Let go of what no later moment of judgement reaches back to."""
        oldest_s = self._newest_s - WINDOW_S - STEP_S
        for times in self._arrivals.values():
            del times[: next((i for i, t in enumerate(times) if t > oldest_s), len(times))]

    def _look(self, now_s: float) -> list[NoData | DataAgain]:
        found = tuple(self._judge(self._lately(now_s), now_s))
        standing = frozenset(problem.code for problem in found)
        if standing != self._standing or self._since_s is None:
            self._standing, self._since_s = standing, now_s
        stood_s = now_s - self._since_s
        told = {problem.code for problem in self.problems}
        if told and not found and stood_s >= SERVED_AFTER_S:
            self.problems = ()
            return [DataAgain()]
        if standing == told or not found or stood_s < LAPSED_AFTER_S:
            return []
        self.problems = found
        return [] if standing < told else [NoData(found)]

    def _lately(self, now_s: float) -> dict[str, ChannelStatus]:
        """How every channel arrived within the window, from its fastest source."""
        found: dict[str, ChannelStatus] = {}
        for (channel, source), times in self._arrivals.items():
            newest = [t for t in times if now_s - WINDOW_S < t <= now_s]
            rate_hz = len(newest) / WINDOW_S
            if len(newest) and (channel not in found or rate_hz > found[channel].rate_hz):
                found[channel] = ChannelStatus(source, "", rate_hz, WINDOW_S, newest[-1])
        return found
