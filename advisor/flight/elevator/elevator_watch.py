"""Elevator samples in the order of their stamps, searched for manoeuvres.

A link may deliver packets out of order. Samples wait a short vehicle time before the segmenter takes them. A
manoeuvre that has ended waits until the other channels have arrived. Both waits are measured by the
elevator's stamps, so that live and replay cut at equal samples.
"""

import heapq
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from advisor.flight.maneuvers.maneuver import ManeuverStarted, Span
from advisor.flight.maneuvers.segmentation import Segmenter

LATE_S = 0.3
"""Time that elevator samples wait for packets out of order, s."""
SETTLE_S = 1.1
"""Time from the end of a manoeuvre to its release, s, for the arrival of all channels and a heartbeat."""


class ElevatorWatch:
    """Segmenter with a queue of elevator samples, for one power-on of the vehicle."""

    def __init__(self) -> None:
        self._segmenter = Segmenter()
        self._waiting: list[tuple[float, int, float | None]] = []
        self._ended: list[Span] = []
        self._announced_s: float | None = None
        self.newest_s = -np.inf
        """Newest stamp of the elevator, s since boot."""

    @property
    def onset_s(self) -> float | None:
        """Begin of the input that is being flown, s. None between two inputs."""
        return self._segmenter.onset_s

    @property
    def amplitude(self) -> float:
        """Largest deviation of the present input so far, rad."""
        return self._segmenter.amplitude

    @property
    def last_step_s(self) -> float | None:
        """Last step of the input whose free response is being recorded, s. None before the end of the
        input."""
        recognised = self._segmenter.recognised
        return recognised.last_step_s if recognised else None

    def mode_changed(self, t: float, order: int) -> None:
        """Take a flight mode change that happened at vehicle time ``t`` or later."""
        heapq.heappush(self._waiting, (t, order, None))

    def push(self, t: float, order: int, elevator: float) -> Iterator[ManeuverStarted | Span]:
        """Take an elevator sample in order of arrival; yield recognised inputs and complete movements."""
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
        """Return the movements that are complete at the end of the samples."""
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
    """Return a movement that ended before a mode change at ``t`` became known."""
    if span.end_s <= t or span.start_s >= t:
        return span
    return replace(span, end_s=max(t, span.last_step_s), closed_by="mode change")
