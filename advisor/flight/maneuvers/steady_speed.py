"""End of a manoeuvre where the air speed leaves the model's range.

The model is valid at one air speed. A held step slows the aircraft for many seconds after the short period
has decayed. Only the part of the record at nearly constant speed is used.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.movement import FREE_S
from advisor.flight.signals.derived_alpha import integrated
from advisor.flight.signals.record import Channel
from advisor.process.arrays import FloatArray, IntArray

FOLLOWED_PERCENT = 15.0
"""Largest change of the air speed that the model follows, %, whatever the user allows.

At this change the dynamic pressure is 28 % lower. At 90 m/s the held step of a business jet has M_δe -7.5 ±
0.4. A limit of 8 to 30 % gives -8.0 to -6.9, with an interval that contains -7.5. A limit of 40 % gives -6.5
± 0.5. A limit of 5 % leaves too short a record."""
LEFT = "air speed"
"""Reason for the end of a span where the air speed left the model's range."""


def speed_before(airspeed: Channel, span: Span) -> float:
    """Return the air speed before the first step, m/s: the median of the lead-in, else the first value."""
    before = airspeed.cut(span.record_from_s, span.start_s).y
    return float(np.median(before if len(before) else airspeed.y[:1]))


def at_steady_speed(span: Span, airspeed: Channel | None, change_percent: float) -> Span:
    """Return the span up to the time at which the air speed leaves its value before the first step.

    Parameters
    ----------
    airspeed
        Air speed during the record, m/s. None without a received air speed.
    change_percent
        Largest change of the air speed that the user allows, % of its value before the first step. The span
        ends at a change of ``FOLLOWED_PERCENT`` at the latest.

    Returns
    -------
    Span
        The span is unchanged if the speed leaves its limits during the input. A step held for the least free
        response counts as an input with its response.
    """
    if airspeed is None or len(airspeed) < 2 or not (trim := speed_before(airspeed, span)) > 0.0:
        return span
    off = np.abs(airspeed.y / trim - 1.0) > 0.01 * min(change_percent, FOLLOWED_PERCENT)
    # One wild reading of the air speed is no change of speed.
    leaving = np.flatnonzero(off[:-1] & off[1:] & (airspeed.t[:-1] > span.start_s))
    if len(leaving) == 0:
        return span
    left_s = float(airspeed.t[max(int(leaving[0]) - 1, 0)])
    if not span.start_s < left_s < span.end_s:
        return span
    if left_s >= span.last_step_s:
        return replace(span, end_s=left_s, closed_by=LEFT)
    steps = tuple(step for step in span.steps if step[0] < left_s)
    if not steps or left_s - steps[-1][0] < FREE_S[0]:
        return span
    return replace(span, last_step_s=steps[-1][0], end_s=left_s, kind="other", steps=steps, closed_by=LEFT)


HISTORY_S = 30.0
"""Length of flight before a movement that shows the hands' loop and remnant, s: two tests with hands between
them."""
_TARGET_S = 15.0
"""Length of flight before a movement that contains the hands' target of the angle, s: one test with its free
response, and some steady flight."""
BIN_S = 0.1
"""Length over which the control is averaged, s: the shortest delay of a hand (McRuer & Krendel 1974)."""
FEWEST = 20
"""Least number of bins of hand flying before a movement: five for each of the loop's four numbers."""
LEVEL = 10
"""Number of bins before a movement whose median is the level from which the control moves: one second."""
_AFTER_S = 0.6
"""Length after the last step that shows its edge, s: a slow hand-flown edge."""


@dataclass(frozen=True, slots=True)
class Bins:
    """Control in bins of equal length, from the seconds before to the end of a movement."""

    middle_s: FloatArray
    moved: FloatArray
    """Shape (n,): deviation from the level before the movement, rad."""
    first: int
    """Index of the movement's first bin."""
    hands: IntArray
    """Indices of the bins before the movement that show the hands, like the bin before each of them."""

    @property
    def movement(self) -> slice:
        return slice(self.first, len(self.moved))

    @property
    def within(self) -> int:
        """Number of the movement's bins."""
        return len(self.moved) - self.first

    @property
    def count(self) -> int:
        """Number of bins that the models explain."""
        return len(self.hands) + self.within

    def begin_s(self, index: int) -> float:
        """Return the time at which a bin of the movement begins, s."""
        return float(self.middle_s[self.first + index] - 0.5 * BIN_S)


def shows_hands(control: Channel) -> bool:
    """Return whether a control is sampled more quickly than hands respond."""
    return len(control) < 2 or float(np.median(np.diff(control.t))) < 0.99 * BIN_S


def binned(span: Span, control: Channel, tests: Sequence[tuple[float, float]]) -> Bins | None:
    """Return the control in bins; None if too few bins before the movement show the hands.

    Parameters
    ----------
    tests
        Earlier tests of this control, from begin to end of the free response, s. They show no hands.
    """
    before = int(min(HISTORY_S, span.start_s - control.t[0]) / BIN_S)
    end_s = min(span.last_step_s + _AFTER_S, span.end_s, float(control.t[-1]))
    edges = np.arange(span.start_s - before * BIN_S, max(end_s, span.start_s + BIN_S), BIN_S)
    if before < FEWEST or len(edges) < before + 4:
        return None
    mean = np.diff(np.interp(edges, control.t, integrated(control.t, control.y))) / BIN_S
    middle_s = 0.5 * (edges[1:] + edges[:-1])
    free = middle_s < span.start_s
    for begin_s, over_s in tests:
        free &= (middle_s < begin_s - BIN_S) | (middle_s > over_s + 0.5 * BIN_S)
    hands = np.flatnonzero(free[1:] & free[:-1]) + 1
    if len(hands) < FEWEST:
        return None
    level = float(np.median(mean[max(0, before - LEVEL) : before]))
    return Bins(middle_s, mean - level, before, hands)


class Motion:
    """Motion that hands respond to, in the bins of a control."""

    def __init__(self, bins: Bins, rate: Channel, angle: Channel, side: float) -> None:
        self._bins, self._rate, self._angle, self._side = bins, rate, angle, side
        start_s = bins.begin_s(0)
        lately = angle.cut(start_s - _TARGET_S, start_s).y
        kept = lately if len(lately) else angle.y[:1]
        self._target, reach = float(np.median(kept)), float(np.ptp(kept))
        self._targets = float(np.min(kept)) - reach, float(np.max(kept)) + reach
        self._since_s = bins.middle_s - start_s + 0.5 * BIN_S

    def terms(self, delay_s: float, taken_over_s: Sequence[tuple[float, float]]) -> FloatArray:
        """Return the terms of the hands' control loop for k times at which hands take over, shape (4·k, n).

        The terms are the rate, the angle from the least and from the largest target, and the integral.
        """
        bins = self._bins
        at_s = bins.middle_s - delay_s
        theta = np.interp(at_s, self._angle.t, self._angle.y)
        summed = np.cumsum(theta - self._target) * BIN_S
        terms = [np.interp(at_s, self._rate.t, self._rate.y), *(theta - end for end in self._targets)]
        terms.append(summed - summed[bins.first])
        begin_s, lasts_s = np.array(taken_over_s).T[:, :, None]
        ramps = np.clip((self._since_s - begin_s) / lasts_s, 0.0, 1.0)
        gates = np.where(np.arange(len(at_s)) >= bins.first, ramps, 1.0)
        return np.asarray(self._side * (gates[:, None] * np.array(terms)).reshape(-1, len(at_s)))
