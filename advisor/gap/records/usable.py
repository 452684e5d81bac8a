"""Which manoeuvres can be used, and what of each was recorded while command and pitch rate both were."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuver import Maneuver
from advisor.flight.messages import FloatArray
from advisor.flight.renewal import renewed
from advisor.gap.records.edges import step_unseen
from advisor.gap.records.flights import Measured
from advisor.gap.simulator.layout import OUTPUTS

LEAST_SAMPLES = 15
"""Of a channel in a manoeuvre: what a derived α of 8 Hz brings in the shortest."""
_LEAST_RENEWED = 30
"""Renewals below which a channel that repeats itself is taken as it is: a vane may stick."""
_MANY_HZ, _ENOUGH_HZ = 80.0, 50.0
"""Rate from which on neighbours are averaged, and the one that is enough: six samples a period of the fastest
structure that is sought, fifteen of the fastest short period."""
_PAIR = 2
_NEIGHBOURS = 1.5
"""Times the usual interval between stamps that are next to each other."""
DEPARTED_RAD = 1.0
"""Swing of the angle of attack that no equation about a trim describes any more."""
_ENOUGH = 4
"""Manoeuvres with all that is needed that are enough to leave the others out."""


def usable_of(maneuvers: Sequence[Maneuver]) -> list[Maneuver]:
    """The manoeuvres that can be used, in their order.

    Left out are those without elevator or pitch rate, those that departed, and, where enough others are
    left, those in which a step of the command fell into a hole of the log or without an angle of attack.
    """
    usable = [m for m in maneuvers if _is_recorded(m) and not _departed(m)]
    for is_whole in (_steps_seen, _has_alpha):
        better = [m for m in usable if is_whole(m)]
        if len(better) >= _ENOUGH:
            usable = better
    return usable


def why_left_out(m: Maneuver) -> str:
    """Say of a manoeuvre that ``usable_of`` left out what it lacks."""
    if not _is_recorded(m):
        return "elevator or pitch rate were not recorded throughout"
    if _departed(m):
        return "the aircraft departed"
    if not _steps_seen(m):
        return "a step of the command fell into a hole of the log"
    return "no angle of attack was recorded"


def recorded(m: Maneuver) -> tuple[float, float]:
    """Vehicle times in s between which both elevator and pitch rate were recorded."""
    both = m.channels["elevator"].t, m.channels["q"].t
    return max(float(t[0]) for t in both), min(float(t[-1]) for t in both)


def outputs_of(m: Maneuver) -> dict[str, Measured]:
    """Channels that are compared, as far as they were renewed meanwhile; times from its beginning."""
    start, end = recorded(m)
    outputs = {}
    for name in OUTPUTS:
        channel = m.channels.get(name)
        if channel is None or len(channel) < LEAST_SAMPLES:
            continue
        cut = channel.cut(start, end)
        t, y = condensed(*renewed(cut.t - start, cut.y, _LEAST_RENEWED))
        if len(t) >= LEAST_SAMPLES:
            outputs[name] = Measured(t, y)
    return outputs


def condensed(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Means of neighbours in time, ``t`` and ``y`` of shape (n,), where a channel comes faster than it need.

    None of what is sought changes within them, and noise weighs the same: every step takes less time.
    """
    interval = float(np.median(np.diff(t))) if len(t) > 1 else 1.0
    together = int(1.0 / (_ENOUGH_HZ * interval) + 1e-3) if interval < 1.0 / _MANY_HZ else 1
    if together < _PAIR:
        return t, y
    begins = np.flatnonzero(np.diff(t, prepend=-np.inf) > _NEIGHBOURS * interval)
    place = np.arange(len(t)) - np.repeat(begins, np.diff(begins, append=len(t)))
    first = np.flatnonzero(place % together == 0)
    size = np.diff(first, append=len(t))
    return np.add.reduceat(t, first) / size, np.add.reduceat(y, first) / size


def _is_recorded(m: Maneuver) -> bool:
    found = m.channels
    if not all(name in found and len(found[name]) >= LEAST_SAMPLES for name in ("elevator", "q")):
        return False
    return len(found["elevator"].cut(*recorded(m))) >= LEAST_SAMPLES and "q" in outputs_of(m)


def _departed(m: Maneuver) -> bool:
    alpha = m.channels.get("alpha")
    return alpha is not None and len(alpha) > 0 and float(np.ptp(alpha.y)) >= DEPARTED_RAD


def _steps_seen(m: Maneuver) -> bool:
    return not step_unseen(m)


def _has_alpha(m: Maneuver) -> bool:
    return "alpha" in outputs_of(m)
