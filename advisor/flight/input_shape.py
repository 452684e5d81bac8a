"""Telling inputs apart: lobes on either side of trim, how long each lasts, how square it is.

Works on a stretch of elevator that has just come to rest. The amplitude is its largest
deviation from trim, the quiet level is what the elevator does at trim before the first step.
"""

import numpy as np

from advisor.flight.lobes import lobes, onsets, squareness
from advisor.flight.maneuver import InputKind
from advisor.flight.messages import FloatArray
from advisor.flight.shape import BAND, Shape
from advisor.flight.stretch import RESTING_S, Stretch, at_rest, median
from advisor.flight.swept_input import recognise_swept

SMALLEST_RAD = float(np.radians(0.15))
"""Smaller inputs than this are no test inputs."""

_SQUARE = {"pulse": 0.7, "doublet": 0.6, "other": 0.6, "3-2-1-1": 0.4, "reverse 3-2-1-1": 0.4}
"""Least share of an input's time spent on its levels: half a sine reaches 0.45, a hand's steps 0.62. Less
will do for a pattern whose timing already gives it away."""
_SHARP = 0.2
"""Longest time from a fifth to four fifths of a step, as a share of the shortest level; a sine takes 0.23."""
_SHARP_3211 = (0.33, 0.5)
"""The same for the pattern, where reversals go from side to side; there a sine takes 0.41. The second holds
for a measured surface, drawn out by its servo, when much quiet before it speaks for a test input."""
_HAND_S = (0.1, 0.25)
"""A hand needs at least the one for that part of a step, and at most the other."""
_QUIET_S = {"pulse": 1.5, "doublet": 0.9, "other": 0.9}
"""Inputs that a correction might resemble are told from it by the quiet before them: this long."""
_JUST_BEGUN_S = 0.1
"""Enough quiet where the record itself begins only then."""
_LEAST_LEVEL = 0.4
"""A lobe smaller than this share of the largest is no step of a known input."""


def recognise(t: FloatArray, u: FloatArray) -> Shape | None:
    """The input after which the elevator has now come to rest, if there is one.

    Parameters
    ----------
    t, u
        Shape (n,): stamps (s) and elevator (rad), up to now.

    Returns
    -------
    Shape or None
        None also when the elevator moves now, rests at another level than before the
        movement (a trim change), or moved in no recognisable way.
    """
    stretch = at_rest(t, u)
    if stretch is None:
        return None
    found = _recognised(stretch)
    return found if found is not None else recognise_swept(stretch, SMALLEST_RAD)


def _recognised(stretch: Stretch) -> Shape | None:
    """The input of steps between the last rest and now."""
    found = _extent(stretch)
    if found is None:
        return None
    before, first, last = found
    # Nothing after ``last`` is larger: it would be away from trim, too.
    amplitude = float(stretch.largest[first])
    if amplitude < SMALLEST_RAD or stretch.rest_range > 0.4 * amplitude:
        return None
    earlier = stretch.d[before:first]
    if abs(float(earlier.mean())) > 0.5 * BAND * amplitude:
        return None
    quiet = float(np.std(earlier))
    if amplitude < 5.0 * quiet:
        return None
    shape = _classify(stretch, first, last, amplitude, quiet)
    if shape is None:
        return None
    rested_s = float(stretch.t[first] - stretch.t[before])
    if shape.is_3211:
        clear = rested_s >= _QUIET_S["other"] and amplitude >= 10.0 * quiet
        return shape if _is_sharp(stretch, shape, _SHARP_3211[int(clear)]) else None
    steady = rested_s >= _QUIET_S[shape.kind] and amplitude >= 8.0 * quiet
    return shape if steady and _is_sharp(stretch, shape, _SHARP) else None


def _extent(stretch: Stretch) -> tuple[int, int, int] | None:
    """Indices: start of the quiet before, first and last sample away from trim.

    Goes back in time from the rest: the band around trim widens with the largest deviation
    met so far, and the input ends where the elevator stays in the band for as long as it
    would between two inputs.
    """
    t = stretch.t
    band = np.maximum(BAND * stretch.largest, max(0.5 * SMALLEST_RAD, stretch.rest_range))
    away = np.flatnonzero(np.abs(stretch.d) > band)
    if len(away) == 0:
        return None
    last = int(away[-1])
    gaps = np.flatnonzero(t[away[1:]] - t[away[:-1] + 1] >= RESTING_S)
    if len(gaps):
        first = int(away[gaps[-1] + 1])
        before = int(away[gaps[-1]]) + 1
    else:
        first = int(away[0])
        before = 0
    rested = _JUST_BEGUN_S if before == 0 else 0.8 * RESTING_S
    before = max(before, int(t.searchsorted(t[first] - 1.7)))
    if first - before < 2 or t[first] - t[before] < rested:
        return None
    return before, first, last


def _classify(stretch: Stretch, first: int, last: int, amplitude: float, quiet: float) -> Shape | None:
    t, d = stretch.t, stretch.d
    places = lobes(d, first, last, BAND * amplitude)
    levels = np.array([median(d[a : b + 1]) for a, b in places])
    if np.min(np.abs(levels)) < 0.5 * BAND * amplitude:
        return None
    times = onsets(t, d, places, levels)
    durations = np.diff(times)
    kind = _kind(levels, durations, t[first - 1 : last + 2])
    if kind is None or squareness(t, d, levels, times, quiet) < _SQUARE[kind]:
        return None
    leaving = np.flatnonzero(np.abs(d[: first + 1]) <= 0.1 * amplitude + 2.0 * quiet)
    start_s = float(t[leaving[-1]]) if len(leaving) else float(t[first])
    start_s = max(start_s, float(times[0]) - 0.3 * float(durations[0]))
    steps = (*zip(times[:-1].tolist(), levels.tolist(), strict=True), (float(times[-1]), 0.0))
    over_s = float(t[min(last + 1, len(t) - 1)])
    return Shape(kind, start_s, float(times[-1]), over_s, stretch.trim, amplitude, quiet, steps)


def _is_sharp(stretch: Stretch, shape: Shape, share: float) -> bool:
    """Whether the elevator steps from level to level, in this share of the shortest, or swings."""
    t, d = stretch.t, stretch.d
    shortest = float(np.min(np.diff([onset for onset, _ in shape.steps])))
    least, most = _HAND_S
    longest = max(least, share * shortest) if shape.is_3211 else min(most, max(least, share * shortest))
    longest += 1.5 * stretch.interval_s
    old = 0.0
    for onset, new in shape.steps:
        i = int(np.clip(np.searchsorted(t, onset), 1, len(t) - 1))
        if t[i] - t[i - 1] > longest:
            # Nobody saw this step: whether the manoeuvre stands such a gap is judged later.
            old = new
            continue
        near = np.abs(t - onset) <= shortest
        done = np.sign(new - old) * (d - old) / max(abs(new - old), 1e-12)
        left = np.flatnonzero(near & (done <= 0.2) & (t <= onset))
        arrived = np.flatnonzero(near & (done >= 0.8) & (t >= onset))
        if len(left) == 0 or len(arrived) == 0:
            return False
        if arrived[0] > left[-1] + 1 and t[arrived[0]] - t[left[-1]] > longest:
            return False
        old = new
    return True


def _kind(levels: FloatArray, durations: FloatArray, t: FloatArray) -> InputKind | None:
    """Which input these lobes are by their timing, None for movements that are no test input."""
    if len(levels) == 1:
        return "pulse" if 0.08 <= durations[0] <= 4.0 else None
    sizes = np.abs(levels)
    even = bool(np.all(sizes / np.max(sizes) >= _LEAST_LEVEL))
    if len(levels) == 2 and even and 0.5 <= durations[0] / durations[1] <= 2.0:
        return "doublet"
    if len(levels) == 4 and even:
        unit = float(np.sum(durations)) / 7.0
        step_s = float(np.max(np.diff(t)))
        near = np.abs(durations - unit * np.array([[3, 2, 1, 1], [1, 1, 2, 3]])) <= 0.45 * unit + step_s
        forwards, backwards = np.all(near, axis=1)
        if forwards or backwards:
            return "3-2-1-1" if forwards and levels[0] < 0.0 else "reverse 3-2-1-1"
    return "other"
