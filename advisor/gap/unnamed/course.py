"""The course of an unknown moment: does it come of the air, of the stick, or of itself?

Air that passes turns an aircraft, too: the tail meets it later than the wing, and it bends as it passes. Such
a moment has no tone of its own, and is no louder while the stick moves. A servo that hunts or an engine
that beats has a tone; what the stick sets off is louder while it moves.
"""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.noise.probes import KNOTS_S
from advisor.gap.records.flights import Flight

_TONE = 0.7
"""Share of the power in one line of the spectrum: air that moves slowly has up to 0.6 of it there."""
_LINE = 2.0
"""Half the width of such a line, over the inverse of a record's length (Hann's window)."""
_LOUDER = 2.0
"""Power while the stick moves over that in quiet."""
_FEW = 0.1
"""Power in a usual manoeuvre over that in the loudest."""
_SLOWEST_HZ = 0.1
_POINTS = 512
"""Slower lines are drifts; points of the spectrum, padded."""


def is_of_the_air(flights: Sequence[Flight], courses: Sequence[FloatArray]) -> bool:
    """Whether courses of a disturbance, one value every ``KNOTS_S``, have no tone and ignore the stick."""
    return not has_tone(courses) and louder_with_the_stick(flights, courses) < _LOUDER


def has_tone(courses: Sequence[FloatArray]) -> bool:
    """Whether courses swing of themselves: nearly all of their power is in one line."""
    return tone_of(courses) >= _TONE


def is_in_few(powers: FloatArray) -> bool:
    """Whether most manoeuvres have next to nothing of it; what the stick sets off is in all.

    Parameters
    ----------
    powers
        Shape (manoeuvres,): mean square of what is left, beside the noise.
    """
    beyond = powers - np.min(powers)
    return bool(np.median(beyond) < _FEW * np.max(beyond))


def tone_of(courses: Sequence[FloatArray]) -> float:
    """Share of the power in the strongest line of the spectrum, 0 to 1, over all manoeuvres."""
    power = np.zeros(_POINTS // 2 + 1)
    for course in courses:
        power += np.abs(np.fft.rfft((course - course.mean()) * np.hanning(len(course)), _POINTS)) ** 2
    hz = np.fft.rfftfreq(_POINTS, KNOTS_S)
    power[hz < _SLOWEST_HZ] = 0.0
    width = _LINE / (KNOTS_S * float(np.median([len(course) for course in courses])))
    line = np.abs(hz - hz[int(np.argmax(power))]) <= width
    return float(np.sum(power[line]) / max(float(np.sum(power)), 1e-300))


def louder_with_the_stick(flights: Sequence[Flight], courses: Sequence[FloatArray]) -> float:
    """Mean square of the courses while the stick moves, over that in quiet."""
    moving, quiet = [], []
    for flight, course in zip(flights, courses, strict=True):
        t = KNOTS_S * np.arange(1.0, len(course) + 1.0)
        moving.append(course[(t >= flight.first_step_s) & (t <= flight.last_step_s)])
        quiet.append(course[flight.is_quiet(t)])
    loud, still = (float(np.mean(np.concatenate(part) ** 2)) for part in (moving, quiet))
    return loud / max(still, 1e-300)
