"""Selection of usable manoeuvres, and of the part in which command and pitch rate were both recorded."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.record import renewed
from advisor.gap.records.unmeasured_alpha import is_known_by_motion, outputs_with
from advisor.oem.lost_input import LOST_INTERVAL
from advisor.oem.rows import Signal
from advisor.process.arrays import FloatArray

_STEEP, _SHORT_S = 0.15, 0.02
"""Record: least jump between two stamps that is an edge of the command, as a share of the command's range.
The share holds for intervals of ``_SHORT_S``; for other intervals the product of jump and interval is
compared."""
_HOLE_S, _HOLE = 0.15, 3.5
"""Record: least length of a gap in the command's log, in s, and in usual intervals. The longer of the two
lengths is used."""
_PULSE_S = 0.25
"""Record: length in s of a gap in the log that may hide a whole pulse. Pulses for a fast short period are
shorter."""


def edges_of(t: FloatArray, u: FloatArray) -> FloatArray:
    """Return the edges of the command, shape (m, 4), with the columns of ``Flight.edges``.

    ``t`` and ``u`` are the command's stamps and values, both shape (n,).
    """
    jump = np.diff(u)
    size = np.ptp(u)
    if size <= 0.0:
        return np.empty((0, 4))
    # A jump may spread over two intervals; each has the uncertainty of its own length.
    interval = np.diff(t)
    least = _STEEP * size * min(float(np.median(interval)), _SHORT_S)
    steep = np.flatnonzero(np.abs(jump) * interval > least)
    interval = interval[steep]
    middle = (t[steep] + t[steep + 1]) / 2.0
    return np.column_stack([middle, jump[steep] * interval, interval, _lost(t)[steep]])


def held_from(t: FloatArray) -> FloatArray:
    """Return the time after which each command value was held, shape (n,): its stamp, or the lost stamps'
    middle."""
    return np.asarray(t - np.append(0.0, 0.5 * _lost(t)))


def _steps_seen(maneuver: Maneuver) -> bool:
    """Return whether no step of the command may lie in a gap of the log, where its time is unknown.

    A whole pulse may lie in a gap if the command is equal on both sides.
    """
    t, span = maneuver.channels["elevator"].t, maneuver.span
    interval = np.diff(t)
    edges = edges_of(t, maneuver.channels["elevator"].y)
    hole = max(_HOLE_S, _HOLE * float(np.median(interval)))
    active = interval[(t[1:] > span.start_s) & (t[:-1] < span.last_step_s)]
    changed, longest = np.max(edges[:, 2], initial=0.0), np.max(active, initial=0.0)
    return not (changed > hole or longest > max(hole, _PULSE_S))


def _lost(t: FloatArray) -> FloatArray:
    """Return each interval's excess over the usual one where a stamp was lost, else 0, shape (n - 1,)."""
    interval = np.diff(t)
    usual = float(np.median(interval))
    return np.where(interval > LOST_INTERVAL * usual, interval - usual, 0.0)


LEAST_SAMPLES = 15
"""Record: least number of samples of a channel in a manoeuvre. An α derived at 8 Hz has 15 samples in the
shortest manoeuvre."""
_LEAST_RENEWED = 30
"""Record: least number of renewed samples for the removal of repeated values, because a vane may stick."""
_MANY_HZ, _ENOUGH_HZ = 80.0, 50.0
"""Numerical: rate in Hz above which successive samples are averaged, and the rate after averaging. The rate
after averaging gives six samples per structural mode period and fifteen per short period."""
_PAIR = 2
_NEIGHBOURS = 1.5
"""Numerical: least number of averaged samples, and longest interval between averaged stamps, in usual
intervals."""
DEPARTED_RAD = 1.0
"""Record: range of the angle of attack in rad at which the aircraft departed from controlled flight."""
_ENOUGH = 4
"""Record: least number of complete manoeuvres with which incomplete manoeuvres are left out."""


def usable_of(maneuvers: Sequence[Maneuver]) -> list[Maneuver]:
    """Return the usable manoeuvres in their order.

    A manoeuvre without elevator or pitch rate, or with a departure, is left out. If enough others remain, a
    manoeuvre without angle of attack or with an unseen step is also left out.
    """
    usable = [m for m in maneuvers if _is_recorded(m) and not _departed(m)]
    for is_whole in (_steps_seen, lambda m: "alpha" in outputs_of(m) or is_known_by_motion(m)):
        better = [m for m in usable if is_whole(m)]
        if len(better) >= _ENOUGH:
            usable = better
    return usable


def why_left_out(m: Maneuver) -> str:
    """Return the reason why ``usable_of`` left out a manoeuvre."""
    if not _is_recorded(m):
        return "elevator or pitch rate were not recorded throughout"
    if _departed(m):
        return "the aircraft departed"
    if not _steps_seen(m):
        return "a step of the command lies in a gap of the log"
    return "no angle of attack was recorded"


def recorded(m: Maneuver) -> tuple[float, float]:
    """Return the vehicle times in s between which both elevator and pitch rate were recorded."""
    both = m.channels["elevator"].t, m.channels["q"].t
    return max(float(t[0]) for t in both), min(float(t[-1]) for t in both)


def outputs_of(m: Maneuver) -> dict[str, Signal]:
    """Return the compared channels with their renewed samples, in seconds since the manoeuvre's start."""
    start, end = recorded(m)
    outputs = {}
    for name in outputs_with(m):
        channel = m.channels.get(name)
        if channel is None or len(channel) < LEAST_SAMPLES:
            continue
        cut = channel.cut(start, end)
        t, y = condensed(*renewed(cut.t - start - cut.delay_s, cut.y, _LEAST_RENEWED))
        if len(t) >= LEAST_SAMPLES:
            outputs[name] = Signal(t, y)
    return outputs


def condensed(t: FloatArray, y: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the means of successive samples of a channel that is faster than needed, shapes (n,).

    Effects change little between successive samples, so the averages keep the information and save time.
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
    channels = m.channels
    if not all(name in channels and len(channels[name]) >= LEAST_SAMPLES for name in ("elevator", "q")):
        return False
    return len(channels["elevator"].cut(*recorded(m))) >= LEAST_SAMPLES and "q" in outputs_of(m)


def _departed(m: Maneuver) -> bool:
    alpha = m.channels.get("alpha")
    return alpha is not None and len(alpha) > 0 and float(np.ptp(alpha.y)) >= DEPARTED_RAD
