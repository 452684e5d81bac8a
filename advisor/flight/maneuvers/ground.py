"""Evidence whether the aircraft flew during an elevator movement, from all its telemetry.

An elevator movement in the preflight check, in the take-off run or after a crash is no test input. An
estimate from a movement on the ground would be wrong. The autopilot's statement EXTENDED_SYS_STATE has
priority. The other evidence is the armed flag with ground speed, speed and height together, and air speed
near zero.
"""

from collections.abc import Callable
from math import radians

import numpy as np

from advisor.aircraft.aircraft import Limits
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.signals.derived_alpha import SLOWEST_FLIGHT_M_S
from advisor.flight.signals.record import Channel

# MAV_LANDED_STATE, MAVLink common.xml.
_ON_GROUND, _TAKING_OFF = 1, 3
_FRESH_S = 5.0
"""Time for which a landed state of the autopilot is valid, s. Landed states arrive about once a second."""
STANDING_M_S = 3.0
"""Least ground speed of a moving aircraft, m/s. A receiver at rest shows less than 1 m/s."""
WINDY_M_S = 12.0
"""Largest air speed that wind alone may cause at a parked aircraft, m/s. A higher air speed counts as
flight."""
NEAR_GROUND_M = 3.0
"""Height above the take-off place below which a standing aircraft counts as landed, m."""
_STILL_RAD_S = radians(1.0)
"""Least pitch rate of an aircraft in flight whose elevator moves, rad/s."""

Cut = Callable[[str, float, float], Channel | None]
"""Function that returns a stretch of a channel by name, start and end, s since boot."""


def why_on_ground(span: Span, cut: Cut, limits: Limits) -> str | None:
    """Return in words the evidence that the aircraft did not fly. Return None if the aircraft flew, or
    without evidence.

    Parameters
    ----------
    cut
        Function that returns ``landed_state``, ``armed``, ``groundspeed``, ``airspeed``, ``height`` and ``q``
        if received.
    limits
        Limits of the model in the aircraft file. An air speed within its limit of change belongs to flight,
        however slow it is.
    """
    said = _lately("landed_state", span, cut)
    if _ON_GROUND in said:
        return "the autopilot says that it has landed"
    if _TAKING_OFF in said:
        return "the autopilot says that it takes off"
    if _stands(span, cut):
        if (armed := _lately("armed", span, cut)) and not any(armed):
            return "it is disarmed and stands"
        height_m = _median("height", span, cut)
        if height_m is not None and abs(height_m) < NEAR_GROUND_M:
            return "it stands at the height of take-off"
    ends = [_median("airspeed", span, cut, at_s) for at_s in (span.start_s, span.last_step_s)]
    steady = 1.0 - 0.01 * limits.airspeed_change_percent
    least = min(SLOWEST_FLIGHT_M_S, steady * (_median("airspeed", span, cut) or np.inf))
    if any(speed is not None and 0.0 < speed < least for speed in ends):
        return "it has no flying speed at one end of the movement"
    return None


def _stands(span: Span, cut: Cut) -> bool:
    """Return whether no speed shows motion. A ground speed of exactly zero counts as missing, because the
    receiver may be missing.
    """
    over_ground = _median("groundspeed", span, cut)
    through_air = _median("airspeed", span, cut)
    if over_ground is None or over_ground >= STANDING_M_S or (through_air or 0.0) > WINDY_M_S:
        return False
    q = cut("q", span.start_s, span.end_s)
    still = q is not None and len(q) > 0 and 0.5 * float(np.ptp(q.y)) < _STILL_RAD_S
    return over_ground > 0.0 or still


def _lately(name: str, span: Span, cut: Cut) -> list[float]:
    """Return a channel's value at the beginning of the movement, and all later values."""
    words = cut(name, span.start_s - _FRESH_S, span.end_s)
    if words is None:
        return []
    before = int(np.searchsorted(words.t, span.start_s, side="right"))
    values: list[float] = words.y[max(before - 1, 0) :].tolist()
    return values


def _median(name: str, span: Span, cut: Cut, at_s: float | None = None) -> float | None:
    """Return the median of a channel over the movement, or over one second around a time."""
    start_s, end_s = (span.start_s, span.end_s) if at_s is None else (at_s - 0.5, at_s + 0.5)
    channel = cut(name, start_s, end_s)
    return float(np.median(channel.y)) if channel is not None and len(channel) else None
