"""Recognition of two records of one manoeuvre, as from two copies, two stations, or a link and a .bin.

Vehicle time and attitude decide: in both records the clock shows one pitch angle. Two flights of one
schedule, even simulated ones, differ by more than a log's resolution.
"""

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver

_AGREE_RAD = 3e-4
"""Largest median difference of pitch angle, rad, between two records of one motion. A log in steps of 0.01
deg is 1e-4 rad off. Two simulated flights of one schedule with 1 % of noise differ by 1.4e-3 rad."""
_SKEW_S = 0.01
"""Largest difference between the stamps of one attitude in two logs, s: the time of computing, sending or
writing."""
_COMMON = 0.5
"""Least shared time of two records of one manoeuvre, as a share of the shorter record."""
_FEWEST = 10
"""Fewest samples that are compared."""


def are_one(a: Maneuver, b: Maneuver) -> bool:
    """Return whether two records from different power-ons show one manoeuvre."""
    from_s = max(a.span.start_s, b.span.start_s)
    to_s = min(a.span.end_s, b.span.end_s)
    shorter_s = min(m.span.end_s - m.span.start_s for m in (a, b))
    name = next((n for n in ("theta", "q") if n in a.channels and n in b.channels), None)
    if name is None or not to_s - from_s > _COMMON * shorter_s:
        return False
    one, other = a.channels[name], b.channels[name].cut(from_s, to_s)
    within = (other.t >= one.t[0]) & (other.t <= one.t[-1])
    t, y = other.t[within], other.y[within]
    if len(t) < _FEWEST:
        return False
    apart = np.interp(t, one.t, one.y) - y
    rate = np.gradient(y, t)
    moved = float(rate @ rate)
    skew_s = np.clip(float(rate @ apart) / moved, -_SKEW_S, _SKEW_S) if moved > 0.0 else 0.0
    return bool(np.median(np.abs(apart - skew_s * rate)) <= _AGREE_RAD)


def is_fuller(a: Maneuver, b: Maneuver) -> bool:
    """Return whether ``a`` is the better record of one manoeuvre: marked, or with more samples of elevator
    and q."""
    return _fullness(a) > _fullness(b)


def _fullness(maneuver: Maneuver) -> tuple[bool, int]:
    samples = sum(len(maneuver.channels[name]) for name in ("elevator", "q") if name in maneuver.channels)
    return maneuver.span.closed_by.startswith("marked"), samples
