"""Which manoeuvres can be used, and the part of each in which command and pitch rate were both recorded."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import FloatArray
from advisor.flight.signals.renewal import renewed
from advisor.gap.records.edges import step_unseen
from advisor.gap.records.unmeasured_alpha import is_known_by_motion, outputs_with
from advisor.oem.rows import Signal

LEAST_SAMPLES = 15
"""Record: least number of samples of a channel in a manoeuvre. A derived α at 8 Hz has as many in the
shortest manoeuvre."""
_LEAST_RENEWED = 30
"""Record: least number of renewals below which a repeated value is kept, because a vane may stick."""
_MANY_HZ, _ENOUGH_HZ = 80.0, 50.0
"""Numerical: rate in Hz above which neighbouring samples are averaged, and the rate that remains. The rest
gives six samples per period of the fastest structural mode, and fifteen of the fastest short period."""
_PAIR = 2
_NEIGHBOURS = 1.5
"""Numerical: least number of samples that are averaged, and longest distance between neighbouring stamps, in
usual intervals."""
DEPARTED_RAD = 1.0
"""Record: range of the angle of attack in rad at which the aircraft departed: no equation about a trim
applies."""
_ENOUGH = 4
"""Record: least number of complete manoeuvres that allows incomplete ones to be left out."""


def usable_of(maneuvers: Sequence[Maneuver]) -> list[Maneuver]:
    """Return the usable manoeuvres in their order.

    A manoeuvre without elevator or pitch rate, or with a departure, is left out. Where enough others remain,
    so is one without angle of attack, or with a step of the command in a hole of the log.
    """
    usable = [m for m in maneuvers if _is_recorded(m) and not _departed(m)]
    for is_whole in (_steps_seen, _has_alpha):
        better = [m for m in usable if is_whole(m)]
        if len(better) >= _ENOUGH:
            usable = better
    return usable


def why_left_out(m: Maneuver) -> str:
    """Return what a manoeuvre lacks that ``usable_of`` left out."""
    if not _is_recorded(m):
        return "elevator or pitch rate were not recorded throughout"
    if _departed(m):
        return "the aircraft departed"
    if not _steps_seen(m):
        return "a step of the command fell into a hole of the log"
    return "no angle of attack was recorded"


def recorded(m: Maneuver) -> tuple[float, float]:
    """Return the vehicle times in s between which both elevator and pitch rate were recorded."""
    both = m.channels["elevator"].t, m.channels["q"].t
    return max(float(t[0]) for t in both), min(float(t[-1]) for t in both)


def outputs_of(m: Maneuver) -> dict[str, Signal]:
    """Return the compared channels with their renewed samples, in seconds since the manoeuvre's beginning."""
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
    """Return the means of neighbouring samples where a channel comes faster than needed, shapes (n,).

    Effects change little between neighbours, and the noise keeps its weight, so every step of a fit takes
    less time.
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
    return "alpha" in outputs_of(m) or is_known_by_motion(m)
