"""End of a manoeuvre where the air speed leaves the model's range.

The model is valid at one air speed. A held step slows the aircraft for many seconds after the short period
has decayed. Only the part of the record at nearly constant speed is used.
"""

from dataclasses import replace

import numpy as np

from advisor.flight.maneuvers.free_response import FREE_S
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.signals.record import Channel

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
