"""Elevator samples put in the order of their stamps, watched for manoeuvres.

A link may deliver packets out of order. Samples wait a moment of vehicle time before the segmenter sees
them, and a manoeuvre that has ended waits until the other channels have arrived, too. Both waits are
measured in the elevator's own stamps, so that live and replay cut at the same sample.
"""

import heapq
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from advisor.flight.events import ManeuverStarted
from advisor.flight.maneuver import Span
from advisor.flight.segmentation import Segmenter

LATE_S = 0.3
"""Samples wait this long for packets that a link delivered out of order."""
SETTLE_S = 1.1
"""A manoeuvre is given out this long after its end: every channel has arrived, and a heartbeat."""


class ElevatorWatch:
    """The segmenter behind a queue, for one power-on of the vehicle."""

    def __init__(self) -> None:
        self._segmenter = Segmenter()
        self._waiting: list[tuple[float, int, float | None]] = []
        self._ended: list[Span] = []
        self._announced_s: float | None = None
        self.newest_s = -np.inf
        """Newest stamp of the elevator, s since boot."""

    @property
    def onset_s(self) -> float | None:
        """When the input being flown began; None between inputs."""
        return self._segmenter.onset_s

    def mode_changed(self, t: float, order: int) -> None:
        """The autopilot took another flight mode, at vehicle time ``t`` at the earliest."""
        heapq.heappush(self._waiting, (t, order, None))

    def push(self, t: float, order: int, elevator: float) -> Iterator[ManeuverStarted | Span]:
        """Take a sample in order of arrival; what has been recognised and what is complete by now."""
        heapq.heappush(self._waiting, (t, order, elevator))
        self.newest_s = max(self.newest_s, t)
        while self._waiting and self._waiting[0][0] <= self.newest_s - LATE_S:
            self._release()
        started = self._segmenter.recognised
        if started is not None and started.start_s != self._announced_s:
            self._announced_s = started.start_s
            yield ManeuverStarted(started.start_s, started.kind)
        while self._ended and self.newest_s >= self._ended[0].end_s + SETTLE_S:
            yield self._ended.pop(0)

    def finish(self) -> list[Span]:
        """No more samples will come: everything that is complete enough."""
        while self._waiting:
            self._release()
        spans = [*self._ended, *self._segmenter.finish()]
        self._ended.clear()
        return spans

    def _release(self) -> None:
        t, _, elevator = heapq.heappop(self._waiting)
        if elevator is None:
            self._ended = [_cut(span, t) for span in self._ended]
            ended = self._segmenter.mode_changed(t)
        else:
            ended = self._segmenter.push(t, elevator)
        self._ended += ended


def _cut(span: Span, t: float) -> Span:
    """Return a movement that had ended before it became known that the mode changed at ``t``."""
    if span.end_s <= t or span.start_s >= t:
        return span
    return replace(span, end_s=max(t, span.last_step_s), closed_by="mode change")
