"""The segmenter: finds manoeuvres in the stream of elevator samples, as they end.

A derivative parser marks every fast edge and has to tell a test input from all other work of
the elevator; a wavelet parser needs the time unit beforehand. This one waits until the
elevator has come to rest and then asks of the stretch behind it, on the stretch's own scale,
whether it was an input (`input_shape`). What follows is the free response, until it has
lasted long enough or something ends it. The work per sample is bounded, and a result depends
on the samples alone, not on how they were delivered.
"""

import numpy as np

from advisor.flight.input_shape import SMALLEST_RAD, recognise
from advisor.flight.maneuver import Span
from advisor.flight.messages import FloatArray
from advisor.flight.shape import Shape
from advisor.flight.stretch import RESTING_S, median, range_of

LEAD_IN_S = 1.0
"""How much of the flight before the first step belongs to the record."""
_REACH_S = 30.0
"""How far back the segmenter looks: two of the longest inputs."""
_CHECK_S = 0.1
"""How often it looks."""
_FREE_S = (3.0, 8.0)
"""Free response: as long as the input, but within these."""
_LEAST_FREE_S = 2.5
"""A multisine whose free response is cut short counts from so much on: slow wandering seldom rests so."""
_GAP_S = 1.0
"""A longer gap ends a free response."""
_LONGEST_GAP_S = 3.0
"""A longer one ends everything; over a shorter one an input is recognised, to be refused for the gap."""
_STEP_S = 0.12
"""A movement most of which happens within this time is a step."""


class Segmenter:
    """Takes elevator samples in the order of their stamps; gives spans as they end."""

    def __init__(self) -> None:
        self._t = np.empty(4096)
        self._u = np.empty(4096)
        self._size = 0
        self._from = 0
        self._next_check_s = -np.inf
        self._pending: Shape | None = None
        self._away: list[float] = []
        self._released_s = -np.inf
        self._level: float | None = None
        self._onset_s: float | None = None
        self._mode_changed_s = -np.inf

    @property
    def onset_s(self) -> float | None:
        """Since when the elevator has been away from rest, or the manoeuvre's start in its free response."""
        return self._pending.start_s if self._pending else self._onset_s

    @property
    def recognised(self) -> Shape | None:
        """The input whose free response is being awaited."""
        return self._pending

    def push(self, t: float, u: float) -> Span | None:
        """Take one sample: stamp (s, rising) and elevator (rad)."""
        span = None
        if self._size > self._from:
            last = float(self._t[self._size - 1])
            if t <= last:
                return None
            if t - last > _GAP_S and t - last > self._longest_gap_s():
                span = self._end("gap", last)
                if t - last > _LONGEST_GAP_S:
                    self._forget_all()
        self._store(t, u)
        if self._pending is not None:
            return span or self._follow(self._pending, t, u)
        if t >= self._next_check_s:
            self._next_check_s = t + _CHECK_S
            self._look(t)
            if self._pending is not None and self._pending.start_s < self._mode_changed_s:
                return span or self._end_with_mode()
        return span

    def mode_changed(self, t: float) -> Span | None:
        """The flight mode changed, at ``t`` at the earliest: a free response ends there."""
        self._level, self._onset_s, self._mode_changed_s = None, None, t
        return self._end_with_mode()

    def finish(self) -> Span | None:
        """No more samples will come."""
        if self._size == self._from:
            return None
        last = float(self._t[self._size - 1])
        if self._pending is None:
            self._look(last)
        span = self._end("end of log", last)
        self._forget_all()
        return span

    def _look(self, t: float) -> None:
        window = slice(self._from, self._size)
        times, u = self._t[window], self._u[window]
        resting = u[times.searchsorted(t - RESTING_S) :]
        rest_range, moved = range_of(resting), range_of(u)
        self._watch_onset(times, resting, rest_range)
        if moved < SMALLEST_RAD or rest_range > 0.5 * moved:
            return
        self._pending = recognise(times, u)
        self._away.clear()

    def _watch_onset(self, times: FloatArray, resting: FloatArray, rest_range: float) -> None:
        """Keep track of rest, and of when the elevator left it with a step."""
        steady = len(resting) > 2 and rest_range <= SMALLEST_RAD
        if steady and (self._level is None or abs(float(resting[-1]) - self._level) <= SMALLEST_RAD):
            self._level, self._onset_s = median(resting), None
        elif self._level is not None and self._onset_s is None:
            away = np.abs(resting - self._level)
            gone = np.flatnonzero(away > SMALLEST_RAD)
            if len(gone) and times[-1] - times[len(times) - len(resting) + gone[0]] >= 0.8 * _STEP_S:
                recent = times[len(times) - len(resting) :]
                before = np.interp(recent - _STEP_S, recent, resting)
                stepped = np.max(np.abs(resting - before)) >= 0.7 * np.max(away)
                self._level, self._onset_s = (
                    (self._level, float(recent[gone[0]])) if stepped else (None, None)
                )
        elif self._onset_s is not None and times[-1] - self._onset_s > 0.5 * _REACH_S:
            self._level, self._onset_s = None, None

    def _follow(self, shape: Shape, t: float, u: float) -> Span | None:
        """The free response: ends with time, or when the elevator leaves trim again."""
        if abs(u - shape.trim) > shape.band:
            self._away.append(t)
            if len(self._away) == 2:
                return self._end("next input", self._away[0])
        else:
            self._away.clear()
        duration = shape.last_step_s - shape.start_s
        end_s = shape.last_step_s + min(max(duration, _FREE_S[0]), _FREE_S[1])
        return self._end("quiet", end_s) if t >= end_s else None

    def _end_with_mode(self) -> Span | None:
        """A response ends with the flight mode; what moved the elevator since is the autopilot's own."""
        last_step_s = self._pending.last_step_s if self._pending else -np.inf
        return self._end("mode change", max(self._mode_changed_s, last_step_s))

    def _end(self, why: str, at_s: float) -> Span | None:
        shape, self._pending = self._pending, None
        if shape is None or (why != "quiet" and at_s - shape.over_s < _least_free_s(shape)):
            return None
        times = self._t[self._from : self._size]
        end_s = float(
            times[np.searchsorted(times, at_s, side="right" if why != "next input" else "left") - 1]
        )
        record_from_s = max(shape.start_s - LEAD_IN_S, self._released_s, float(times[0]))
        self._released_s = end_s
        self._from += int(np.searchsorted(times, shape.over_s))
        self._level, self._onset_s = shape.trim, None
        return Span(record_from_s, shape.start_s, shape.last_step_s, end_s, shape.kind, shape.steps, why)

    def _longest_gap_s(self) -> float:
        recent = self._t[max(self._from, self._size - 20) : self._size]
        return 5.0 * float(np.median(np.diff(recent))) if len(recent) > 2 else np.inf

    def _store(self, t: float, u: float) -> None:
        if self._size == len(self._t):
            first = max(self._from, int(np.searchsorted(self._t, t - _REACH_S)))
            kept = slice(first, self._size)
            n = self._size - first
            if n > len(self._t) // 2:
                self._t = np.concatenate((self._t[kept], np.empty(n)))
                self._u = np.concatenate((self._u[kept], np.empty(n)))
            else:
                self._t[:n], self._u[:n] = self._t[kept].copy(), self._u[kept].copy()
            self._from, self._size = 0, n
        self._t[self._size], self._u[self._size] = t, u
        self._size += 1
        while self._t[self._from] < t - _REACH_S:
            self._from += 1

    def _forget_all(self) -> None:
        self._size = self._from = 0
        self._level = self._onset_s = None


def _least_free_s(shape: Shape) -> float:
    """How long the elevator must rest for an input to count when something cuts its free response."""
    if shape.is_3211:
        return -np.inf
    least_s = max(1.0, 2.0 * shape.longest_s)
    return min(least_s, _LEAST_FREE_S) if shape.kind == "multisine" else least_s
