"""Inputs without levels: multisines and frequency sweeps.

A step input is found by its levels. A multisine or a sweep has none: it passes through trim at every speed
and may linger there, so the band around trim that ends a step input would cut it into pieces. What
sets it off is *stillness* before and after, at the same level: between two sines the elevator is near
trim, but it is moving.
"""

from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from advisor.flight.lobes import lobes, onsets
from advisor.flight.messages import FloatArray
from advisor.flight.shape import Shape
from advisor.flight.stretch import Stretch, median, range_of

STILL_S = 1.0
"""The elevator keeps still for so long before and after."""
_STILL = 0.1
"""Range that counts as still, as a share of the input's amplitude."""
_AT_TRIM = 0.2
"""As a share of the amplitude: how far apart the rests may lie, and beyond what a movement is a lobe."""
_RESTLESS = 0.1
"""Range over half of the rest reached, as a share of the amplitude, that noise and corrections may have."""
_NOISE = 2.2
"""Such noise over twice the time has at most so many times that range: a trim that drifts has twice."""
_SWELLING = 3
"""In rests: how long before it counts as moving an input may have begun to swell."""
_NEWLY_S = 0.5
"""A rest is looked at when it has just become long enough, once."""
_FEWEST_LOBES = 5
"""Movements to either side: fewer may be a correction and what comes of it."""
_SLOWEST_LOBE_S = 2.5
"""Half a period of the middle frequency: slower ones are work on the trim."""
_LOPSIDED = 0.35
"""Share of the movement that may be left over when both sides are set against each other."""
_DIES_AWAY = 0.6
"""A later half smaller than this share of the earlier one is a disturbance that dies away."""
_SWELLS = 0.3
"""... and an earlier half smaller than this share of the later one is a movement that grows."""


def recognise_swept(stretch: Stretch, least: float) -> Shape | None:
    """The multisine or sweep after which the elevator has just come to rest, if there is one.

    Parameters
    ----------
    stretch
        The elevator up to now.
    least
        Smallest amplitude of a test input, rad.
    """
    found = _between_rests(stretch)
    if found is None:
        return None
    first, last, start_s, quiet, unrest = found
    t, d = stretch.t, stretch.d
    moved = d[first : last + 1]
    amplitude = float(np.max(np.abs(moved)))
    if amplitude < max(least, 5.0 * quiet) or unrest > _RESTLESS * amplitude:
        return None
    if abs(float(np.sum(moved))) > _LOPSIDED * float(np.sum(np.abs(moved))):
        return None
    halves = np.array_split(np.abs(moved), 2)
    early, late = (float(np.max(half)) for half in halves)
    if late < _DIES_AWAY * early or early < _SWELLS * late:
        return None
    places = lobes(d, first, last, _AT_TRIM * amplitude)
    if len(places) < _FEWEST_LOBES:
        return None
    levels = np.array([float(np.max(np.abs(d[a : b + 1])) * np.sign(d[a])) for a, b in places])
    times = onsets(t, d, places, levels)
    if median(np.diff(times)) > _SLOWEST_LOBE_S:
        return None
    end_s = float(t[last])
    steps = (*zip(times[:-1].tolist(), levels.tolist(), strict=True), (end_s, 0.0))
    return Shape("multisine", start_s, end_s, float(t[last + 1]), stretch.trim, amplitude, quiet, steps)


class _Movement(NamedTuple):
    """What lies between two rests."""

    first: int
    """Last sample before it counts as moving."""
    last: int
    """Last sample that moves."""
    start_s: float
    """When it began, if it began small."""
    quiet: float
    """Standard deviation in the rest before."""
    unrest: float
    """Range in the newest half of the rest after."""


def _between_rests(stretch: Stretch) -> _Movement | None:
    """The movement before the rest just reached.

    Goes back in time from now: what counts as still grows with the largest deviation met so far.
    """
    t, d, largest = stretch.t, stretch.d, stretch.largest
    width = round(STILL_S / stretch.interval_s) + 1
    if len(t) < 3 * width:
        return None
    unrest = range_of(d[-(width // 2) :])
    still_now = max(_STILL * float(largest[-width]), _NOISE * unrest)
    newly = max(0, int(t.searchsorted(t[-1] - _NEWLY_S)) - width + 1)
    # What counts as still only shrinks on the way to now: what passes now's measure passes its own.
    if range_of(d[-width:]) > still_now or range_of(d[newly:]) <= still_now:
        return None
    ranges = _ranges(d, width)
    largest = largest[: len(ranges)]
    still = ranges <= np.maximum(_STILL * largest, _NOISE * unrest)
    moving = np.flatnonzero(~still)
    if len(moving) == 0 or moving[-1] < newly:
        return None
    last = int(moving[-1])
    windows = sliding_window_view(d, width)[:last]
    at_trim = np.abs(windows.mean(axis=1)) <= _AT_TRIM * largest[:last]
    rests = np.flatnonzero(still[:last] & at_trim)
    if len(rests) == 0 or last < rests[-1] + 2 * width:
        return None
    rest = int(rests[-1])
    start = _before_it_swells(ranges, rest, width, float(largest[rest]))
    quiet = float(np.std(windows[rest]))
    return _Movement(rest + width - 1, last, float(t[start + width - 1]), quiet, unrest)


def _ranges(d: FloatArray, width: int) -> FloatArray:
    """Range over every window of this length: two that overlap make one up to twice as long."""
    high = low = d
    length = 1
    while length < width:
        more = min(length, width - length)
        high, low = np.maximum(high[more:], high[:-more]), np.minimum(low[more:], low[:-more])
        length += more
    return high - low


def _before_it_swells(ranges: FloatArray, rest: int, width: int, amplitude: float) -> int:
    """The newest window as quiet as the quietest shortly before ``rest``: an input may begin small."""
    shortly = ranges[max(0, rest - _SWELLING * width) : rest + 1]
    quiet = np.flatnonzero(shortly <= 1.5 * np.min(shortly) + 0.02 * amplitude)
    return rest + 1 - len(shortly) + int(quiet[-1])
