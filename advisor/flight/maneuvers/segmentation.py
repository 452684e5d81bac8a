"""The segmenter: detection of elevator movements in a stream of samples, as each movement ends.

A movement begins where the elevator leaves its rest. A movement ends where the elevator rests again, at the
earlier level, or longer at another level. The limit for rest is a share of the movement's amplitude
(`movement.is_still`). One rule applies to steps, slewed edges, pulses and multisines, of fast and slow
aircraft. The free response follows until it is long enough or an event ends it. Movements are classified
later, with the other channels (`purpose`). The work per sample is bounded. The result depends on the samples
only, not on their batches.
"""

from collections import deque

import numpy as np

from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.movement import (
    SMALLEST_RAD,
    FreeResponse,
    Movement,
    describe,
    is_still,
    median,
    without_spikes,
)
from advisor.flight.signals.record import Samples
from advisor.process.arrays import FloatArray

LEAD_IN_S = 1.0
"""Length of flight before the first step that belongs to the record, s."""
_REACH_S = 60.0
"""Longest movement of the elevator, s. A longer movement is reported in pieces."""
_OVERLAP_S = 10.0
"""Age of a piece's end when the piece is reported, s. An input that has begun since then is complete in the
next piece."""
_CHECK_S = 0.1
"""Time between two tests for rest, s."""
_RESTING_S = 0.5
"""Time for which the elevator must be at rest at the end of a movement, s."""
_FIRST_LEVEL_S = 0.1
"""Time at the beginning of a stream in which the elevator is taken as at rest, s."""
_NEAR = 0.4
"""Largest distance of a rest from the earlier level, as a share of the amplitude, for a return."""
_HOLD_S = (8.0, 20.0)
"""Least length of a rest at another level that ends a movement, s. The second value applies to a single step,
so that a long pulse is one input."""
_LONGER = 1.2
"""Factor on the longest earlier rest at another level, above which a rest ends a movement. A slow input has
long steps at its levels."""
_FAR = 0.3
"""Distance from the earlier level, as a share of the amplitude, at which a movement has begun. The first step
of a 3-2-1-1 with balanced areas has half of the amplitude."""
_LEAST_REST_S = 0.3
"""Least length of a rest before the movement, s, if an earlier movement exists."""
_EDGE_S = 0.2
"""Length over which the elevator's speed is measured, s: half of the slowest hand-flown edge."""
_ABRUPT = 0.3
"""Largest motion over ``_EDGE_S`` in a slow movement, as a share of an abrupt step that follows. If the first
step is half as large, the first edge is a third of the second edge. In gusts of 0.7 m/s, hand flying has up
to 0.3 of the first edge of a test."""
_KEEP_S = _REACH_S + 30.0
"""Time for which samples are kept, s: a movement and its free response."""
GAP_S = 1.0
"""Least gap in the samples, s, that ends a free response, if ``MANY_INTERVALS`` samples are missing."""
MANY_INTERVALS = 5.0
"""Least gap, in intervals of the samples, that ends a free response."""
_LONGEST_GAP_S = 3.0
"""Longest gap in the samples, s, within a movement. A movement with a longer gap is dropped."""


class Segmenter:
    """Detector of movements: takes elevator samples in the order of their stamps, and returns spans as they
    end."""

    def __init__(self) -> None:
        self._samples = Samples(_KEEP_S)
        self._ended: list[Span] = []
        self._begin_anew(-np.inf)

    def _begin_anew(self, from_s: float) -> None:
        """Forget all rests of the elevator before ``from_s``."""
        self._new_from_s = from_s
        self._base: float | None = None
        self._leaving = 0.5 * SMALLEST_RAD
        self._pending: FreeResponse | None = None
        self._set_out(None, 0.0)
        self._next_check_s = -np.inf

    def _set_out(self, from_s: float | None, amplitude: float) -> None:
        """Set the segmenter's state: at rest, or moving since the sample at ``from_s``."""
        self._moved_from_s, self._amplitude = from_s, amplitude
        self._held_since_s: float | None = None
        self._held_rad = 0.0
        self._longest_hold_s = 0.0
        self._edges: deque[tuple[float, float]] = deque()
        self._fastest = 0.0

    @property
    def onset_s(self) -> float | None:
        """Begin of the movement, or of the manoeuvre in its free response, s. None while the elevator is at
        rest."""
        if self._pending:
            return self._pending.movement.start_s
        return self._moved_from_s if self._amplitude >= SMALLEST_RAD else None

    @property
    def amplitude(self) -> float:
        """Largest deviation of the present movement so far, rad."""
        return self._pending.movement.amplitude if self._pending else self._amplitude

    @property
    def recognised(self) -> Movement | None:
        """Movement whose free response is being recorded; None without one."""
        return self._pending.movement if self._pending else None

    def push(self, t: float, u: float) -> list[Span]:
        """Take one elevator sample, stamp (s, rising) and value (rad); return the spans that end there."""
        if self._samples.size:
            last = float(self._samples.t[-1])
            if t <= last:
                return []
            if t - last > GAP_S and t - last > MANY_INTERVALS * self._samples.interval_s():
                self._interrupt(last, whole=t - last > _LONGEST_GAP_S)
        self._samples.append(t, u)
        self._advance(self._samples.size - 1)
        return self._drain()

    def mode_changed(self, t: float) -> list[Span]:
        """Take a mode change that happened at ``t`` or later; return the spans that end there."""
        if self._pending is not None:
            pending = self._pending.movement
            if pending.start_s >= t:
                return []
            self._end(pending, "mode change", max(t, pending.last_step_s))
            t = max(t, pending.over_s)
        elif self._moved_from_s is not None and self._moved_from_s < t:
            self._cut_off("mode change", t)
        self._restart(t)
        return self._drain()

    def finish(self) -> list[Span]:
        if self._samples.size:
            last = float(self._samples.t[-1])
            if self._pending is not None:
                self._end(self._pending.movement, "end of log", last)
            else:
                self._cut_off("end of log", last)
        self._forget_all()
        return self._drain()

    def _drain(self) -> list[Span]:
        ended, self._ended = self._ended, []
        return ended

    def _restart(self, from_s: float) -> None:
        """Process the stored samples since ``from_s`` again, as if the stream began there."""
        self._begin_anew(from_s)
        for i in range(self._samples.index(from_s), self._samples.size):
            self._advance(i)

    def _interrupt(self, last_s: float, whole: bool) -> None:
        """Handle a silence of the link after ``last_s``; a very long one has ``whole`` set."""
        if self._pending is not None:
            self._end(self._pending.movement, "gap", last_s)
            self._begin_anew(last_s)
        elif whole:
            self._cut_off("gap", last_s)
        if whole:
            self._forget_all()

    def _advance(self, i: int) -> None:
        samples = self._samples
        t, u = float(samples.t[i]), float(samples.y[i])
        if self._base is None:
            begun = samples.index(self._new_from_s)
            if i - begun >= 2 and t - samples.t[begun] >= _FIRST_LEVEL_S:
                self._base = median(samples.y[begun : i + 1])
            return
        if self._pending is not None:
            self._follow(self._pending, t, u)
            return
        # A single sample is no movement.
        deviation = min(abs(u - self._base), abs(float(samples.y[i - 1]) - self._base))
        if self._moved_from_s is not None:
            self._amplitude = max(self._amplitude, deviation)
            self._watch_edges(i, t, self._moved_from_s)
        elif deviation > self._leaving:
            self._set_out(float(samples.t[max(i - 2, 0)]), deviation)
        if t >= self._next_check_s:
            self._next_check_s = t + _CHECK_S
            if self._moved_from_s is None:
                if abs(u - self._base) <= self._leaving:
                    self._watch_rest(i, t)
            else:
                self._look(i, t, self._moved_from_s, self._base)

    def _watch_edges(self, i: int, t: float, from_s: float) -> None:
        """Follow a movement's speed, and separate an abrupt step from the slow movement before it."""
        samples = self._samples
        before = max(0, min(samples.index(t - _EDGE_S), i - 3))
        level = float(samples.y[before])
        edge = min(abs(float(samples.y[k]) - level) for k in (i - 1, i))
        onset_s = float(samples.t[before])
        while self._edges and self._edges[0][0] <= onset_s:
            self._fastest = max(self._fastest, self._edges.popleft()[1])
        self._edges.append((t, edge))
        steady_s = onset_s - LEAD_IN_S
        # Neither slow samples nor a gap show an abrupt step.
        if t - onset_s > 2.0 * _EDGE_S or edge < 2.0 * SMALLEST_RAD:
            return
        if self._fastest > _ABRUPT * edge or steady_s < from_s:
            return
        steady = samples.since(steady_s, before + 1)
        if not is_still(steady, edge):
            return
        self._cut_off("no rest", onset_s)
        self._base = median(steady)
        self._set_out(onset_s, edge)
        self._fastest = edge

    def _watch_rest(self, i: int, t: float) -> None:
        """Follow the slow drift of the rest level, and the elevator's movements at rest."""
        recent = self._samples.since(max(t - LEAD_IN_S, self._new_from_s), i + 1)
        if len(recent) > 2:
            self._base = median(recent)
            self._leaving = min(max(4.0 * float(recent.std()), 0.5 * SMALLEST_RAD), 2.0 * SMALLEST_RAD)

    def _look(self, i: int, t: float, from_s: float, base: float) -> None:
        """Test whether the moving elevator is at rest, at the earlier level or for long at another level."""
        if t - from_s > _REACH_S:
            self._cut_off("no rest", t - _OVERLAP_S)
            self._restart(t - _OVERLAP_S)
            return
        rest = self._samples.since(t - _RESTING_S, i + 1)
        if t - from_s < _RESTING_S or not is_still(rest, self._amplitude):
            self._let_go(t)
            return
        level = median(rest)
        if abs(level - base) <= _NEAR * self._amplitude:
            movement = self._described(i + 1, rest)
            if movement is not None:
                self._pending = FreeResponse(movement, base, self._samples)
            else:
                self._base = level
                self._set_out(None, 0.0)
        elif self._held_since_s is None or abs(level - self._held_rad) > _NEAR * self._amplitude:
            self._let_go(t)
            self._held_since_s, self._held_rad = t - _RESTING_S, level
        elif t - self._held_since_s >= self._longest_hold(from_s, base):
            held = self._described(i + 1, rest)
            self._base = level
            if held is not None:
                self._end(held, "quiet", t)
            self._set_out(None, 0.0)

    def _let_go(self, t: float) -> None:
        """Note that the elevator has left a rest away from trim."""
        if self._held_since_s is not None:
            self._longest_hold_s = max(self._longest_hold_s, t - self._held_since_s)
            self._held_since_s = None

    def _longest_hold(self, from_s: float, base: float) -> float:
        """Return the longest rest away from trim within a movement, s."""
        u = without_spikes(self._samples.since(from_s))
        low, high = min(base, self._held_rad), max(base, self._held_rad)
        beyond = max(low - float(u.min()), float(u.max()) - high)
        single = beyond <= _NEAR * self._amplitude and self._longest_hold_s == 0.0
        return _HOLD_S[1] if single else max(_HOLD_S[0], _LONGER * self._longest_hold_s)

    def _follow(self, response: FreeResponse, t: float, u: float) -> None:
        ended = response.take(t, u)
        if ended is None:
            return
        self._pending = None
        if ended.why == "same input":
            return
        movement = response.movement
        self._end(movement, ended.why, ended.at_s)
        self._base = movement.trim
        if ended.why == "quiet":
            self._set_out(None, 0.0)
        else:
            before = max(self._samples.index(ended.at_s) - 1, 0)
            self._set_out(float(self._samples.t[before]), abs(u - movement.trim))

    def _cut_off(self, why: str, at_s: float) -> None:
        """End a movement for a given reason before the elevator is at rest."""
        if self._moved_from_s is None or self._base is None:
            return
        until = self._samples.index(float(np.nextafter(at_s, np.inf)))
        rest = self._samples.since(at_s - _RESTING_S, until)
        movement = self._described(until, rest if is_still(rest, self._amplitude) else None)
        if movement is not None:
            self._end(movement, why, max(at_s, movement.last_step_s))

    def _described(self, until: int, rest: FloatArray | None) -> Movement | None:
        """Return the movement up to the sample ``until``; None if smaller than any input."""
        begin, base = self._rest_before(until)
        if until - begin < 3:
            return None
        t, u = self._samples.t[begin:until], self._samples.y[begin:until]
        movement = describe(t, u, base, rest)
        return movement if movement is not None and movement.amplitude >= SMALLEST_RAD else None

    def _rest_before(self, until: int) -> tuple[int, float]:
        """Return the index and the level of the elevator's last rest before the movement."""
        samples, base = self._samples, self._base or 0.0
        begin = samples.index(self._moved_from_s or 0.0)
        far = np.flatnonzero(np.abs(samples.y[begin:until] - base) > _FAR * self._amplitude)
        end = float(samples.t[begin + int(far[0]) if len(far) else begin])
        while (i := samples.index(end - _LEAST_REST_S)) > begin:
            window = samples.y[i : samples.index(end) + 1]
            if is_still(window, 0.5 * self._amplitude):
                return i, median(window)
            end -= 0.5 * _CHECK_S
        return begin, base

    def _end(self, movement: Movement, why: str, at_s: float) -> None:
        past_s = at_s if why == "next input" else float(np.nextafter(at_s, np.inf))
        end_s = float(self._samples.t[max(0, self._samples.index(past_s) - 1)])
        record_from_s = max(movement.start_s - LEAD_IN_S, float(self._samples.t[0]))
        self._ended.append(
            Span(
                record_from_s,
                movement.start_s,
                movement.last_step_s,
                end_s,
                movement.kind,
                movement.steps,
                why,
            )
        )

    def _forget_all(self) -> None:
        self._samples.clear()
        self._begin_anew(-np.inf)
