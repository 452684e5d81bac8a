"""Air that moves, but neither as turbulence does nor as a gust: a wave, a wake, the edge of a downdraught.

Turbulence has no period, and a gust one bump (1 − cos). The course of the air is known from what it did to
the aircraft (``advisor.gap.search.air``); asked is how much of it has the shape that its name promises.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.flight.robust import robust_std
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.noise.probes import KNOTS_S
from advisor.gap.search.air import Air
from advisor.gap.search.stage import Stage
from advisor.gap.unnamed.leftover import LEAST_OF_GAP, Leftover

_SHORTEST_S = 0.5
"""Period of the quickest wave that knots show."""
_CYCLES = 2.0
"""That a record must have of a wave: of one and a half, any wandering has the shape."""
_PERIODS = 60
_SWINGS = 0.55
"""Share of the air's course that one period explains, from which on it is a wave: in turbulence it explains
0.4 at most (80 flights), in waves 0.7 and more (six of seven)."""
_HIGH = 0.6
"""Share of the largest departure from which on a manoeuvre has a gust of its own."""
_LENGTHS_S = np.geomspace(0.2, 25.0, 40)
_UNLIKE = 0.25
"""Share of the bumps' power that no 1 − cos explains, in the median of the manoeuvres that have one: of gusts
0.16 at most (45 flights), of wakes and downdraughts 0.32 and more (six of seven)."""


def unnamed_air(air: Air, stages: Sequence[Stage], floor: FloatArray) -> Leftover | None:
    """Air whose course has another shape than its name; None where it has that, or is little beside names.

    ``floor`` is the noise of each channel, shape (channels,).
    """
    before, after = (whole_gap(s.held_out.mean_square, floor) for s in (stages[0], stages[-1]))
    if air.power < LEAST_OF_GAP * (before - after):
        return None
    if air.gust and unlike_gusts(air.course) > _UNLIKE:
        return _something("The air moved, but not as a gust does: a wake, or the edge of sinking air.")
    period_s, share = (0.0, 0.0) if air.gust else wave_in(air.course)
    if share > _SWINGS:
        return _something(f"The air rises and sinks every {period_s:.1f} s: a wave.")
    return None


def _something(note: str) -> Leftover:
    return Leftover("air", 1.0, (("air", 1.0),), note=note)


def unlike_gusts(courses: Sequence[FloatArray]) -> float:
    """Share of the bumps' power that no 1 − cos explains, in the median manoeuvre that has one.

    Parameters
    ----------
    courses
        Per manoeuvre, shape (knots,): the air's angle every ``KNOTS_S``, rad.
    """
    joined = np.concatenate(courses)
    # By as much a course wanders where no gust is.
    wanders = robust_std(joined - np.median(joined))
    highest = float(np.max(np.abs(joined)))
    return float(
        np.median([_not_one_bump(c, wanders) for c in courses if np.max(np.abs(c)) >= _HIGH * highest])
    )


def _not_one_bump(course: FloatArray, wanders: float) -> float:
    """Share of a course's power that the likeliest 1 − cos leaves, beyond what it wanders by itself."""
    power = float(course @ course)
    left = power - max(_power_of(course, bump) for bump in _bumps())
    return max(left - len(course) * wanders**2, 0.0) / power


def _bumps() -> Iterable[FloatArray]:
    """One 1 − cos of every length, its middle at a knot or half-way between two."""
    for length_s in _LENGTHS_S:
        half = int(0.5 * length_s / KNOTS_S) + 1
        for shift in (0.0, 0.5):
            t = (np.arange(-half, half + 1) + shift) * KNOTS_S
            yield np.where(np.abs(t) < 0.5 * length_s, 0.5 + 0.5 * np.cos(2.0 * np.pi * t / length_s), 0.0)


def _power_of(course: FloatArray, bump: FloatArray) -> float:
    """Power of a course that a bump explains where it fits best; a record may begin or end within it."""
    products = np.correlate(course, bump, "full")
    squares = np.correlate(np.ones(len(course)), bump**2, "full")
    there = squares > 0.1 * np.max(squares)
    return float(np.max(products[there] ** 2 / squares[there]))


def wave_in(courses: Sequence[FloatArray]) -> tuple[float, float]:
    """Period in s, and the share of the air's course that it explains, whatever its phase in each manoeuvre.

    ``courses`` as for ``unlike_gusts``.
    """
    longest = float(np.median([len(c) for c in courses])) * KNOTS_S / _CYCLES
    if longest <= _SHORTEST_S:
        return 0.0, 0.0
    centred = [c - np.mean(c) for c in courses]
    power = sum(float(c @ c) for c in centred)
    found = [
        (sum(_power_at(c, period) for c in centred) / power, period)
        for period in np.geomspace(_SHORTEST_S, longest, _PERIODS)
    ]
    share, period = max(found)
    return float(period), share


def _power_at(course: FloatArray, period_s: float) -> float:
    """Power of a centred course that one period explains."""
    phase = 2.0 * np.pi * KNOTS_S / period_s * np.arange(len(course))
    columns = np.column_stack([np.cos(phase), np.sin(phase)])
    columns -= np.mean(columns, axis=0)
    basis = np.linalg.qr(columns)[0]
    return float(np.sum((basis.T @ course) ** 2))
