"""Description of an elevator movement: its begin and end, its levels, and a name for the input.

The name of an input is only a label. A movement's acceptance as a test input does not depend on the name.

A stick is never perfectly still, so rest is relative to the size of the movement. After a large input, a hand
that shakes by a tenth of it counts as at rest. After a smaller input, the same shaking would not count as
rest.
"""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from advisor.flight.maneuvers.maneuver import InputKind
from advisor.flight.signals.record import Samples
from advisor.process.arrays import FloatArray

SMALLEST_RAD = float(np.radians(0.15))
"""Least amplitude of a movement, rad: somewhat more than two steps of 1 us at 0.06 deg per microsecond."""
STILL_SPREAD = 0.15
"""Largest standard deviation of the elevator at rest, as a share of the movement's amplitude. A shaking stick
has 0.1 of its amplitude, and a sine has 0.7."""
_STILL_SHIFT = 0.12
"""Largest difference between the means over the thirds of a rest, as a share of the amplitude."""


def median(x: FloatArray) -> float:
    """Return the median without a test for NaN, faster than NumPy for few numbers."""
    middle = np.sort(x)[(len(x) - 1) // 2 : len(x) // 2 + 1]
    return float(middle.sum() / len(middle))


def is_still(u: FloatArray, amplitude: float) -> bool:
    """Return whether the elevator is at rest in a window, relative to a movement of this amplitude.

    Parameters
    ----------
    u
        Shape (n,): elevator in the window, rad.
    amplitude
        Largest deviation of the movement, rad.

    Returns
    -------
    bool
        True if spread and drift of the elevator in the window are small. White noise may have a spread up to
        ``STILL_SPREAD``. The means over thirds show a drift in one direction.
    """
    if len(u) < 3 or float(u.std()) > STILL_SPREAD * amplitude:
        return False
    third = len(u) // 3
    means = (float(u[:third].mean()), float(u[third:-third].mean()), float(u[-third:].mean()))
    # Second differences separate white noise from a moving level.
    bent = u[2:] - 2.0 * u[1:-1] + u[:-2]
    noise = 2.0 * float(np.sqrt((bent * bent).mean() / (6.0 * third)))
    return max(means) - min(means) <= _STILL_SHIFT * amplitude + min(noise, STILL_SPREAD * amplitude)


def without_spikes(u: FloatArray) -> FloatArray:
    """Return the running median of three samples, which removes single outliers."""
    if len(u) < 3:
        return u
    low, high = np.minimum(u[:-2], u[1:-1]), np.maximum(u[:-2], u[1:-1])
    return np.concatenate(([u[0]], np.maximum(low, np.minimum(high, u[2:])), [u[-1]]))


BAND = 0.3
"""Distance from trim, as a share of the amplitude, within which the elevator counts as at trim."""
RETURNED = 0.45
"""Largest difference between the rests before and after, as a share of the amplitude, for a return to trim. A
rest farther from trim is a step."""
_LEAVING = 0.1
"""Deviation from trim, as a share of the amplitude, at which a movement begins."""
_EDGE_S = 0.6
"""Longest duration of a step's edge, s. Hand-flown edges take 0.2 to 0.4 s."""
_LEAST_LEVEL = 0.4
"""Least amplitude of a lobe in a pattern of steps, as a share of the largest lobe."""
_TIMING = 0.45
"""Tolerance of the durations of a 3-2-1-1, in units of its time unit. Hand-flown step durations differ by a
third."""
_ON_LEVEL = 0.4
"""Least share of its duration that a stepped input spends on its levels. Steps with edges of half their
duration spend half on levels; multisines spend a third."""
_SWEPT_LOBES = 5
"""Least number of lobes of a movement without levels that is named a multisine."""


@dataclass(frozen=True, slots=True)
class Movement:
    """Movement of the elevator between two rests."""

    kind: InputKind
    start_s: float
    """Time at which the elevator leaves trim, s."""
    last_step_s: float
    """Onset of the last step, s, which leads to trim or to the level of the following rest."""
    over_s: float
    """Time at which the elevator comes to rest after the movement, s."""
    trim: float
    """Elevator level in the rest after the movement, rad."""
    amplitude: float
    """Largest deviation from the levels before and after the movement, rad."""
    quiet: float
    """Standard deviation in the rest after the movement, rad; 0 without a following rest."""
    steps: tuple[tuple[float, float], ...]
    """Steps of the movement as (onset in s, level in rad from trim). The last step is the return to trim."""
    is_stepped: bool
    """Whether the elevator spends enough of the movement on constant levels."""


def describe(t: FloatArray, u: FloatArray, before: float, rest: FloatArray | None) -> Movement | None:
    """Return a description of the movement in a stretch that begins at rest.

    Parameters
    ----------
    t, u
        Shape (n,): stamps (s) and elevator (rad), from the earlier rest to the newest sample.
    before
        Level of the earlier rest, rad.
    rest
        Newest samples of ``u``, at which the elevator is at rest. None if the movement was cut off.

    Returns
    -------
    Movement or None
        None if the elevator did not move.
    """
    after = before if rest is None else median(rest)
    quiet = 0.0 if rest is None else float(np.std(rest))
    smooth = without_spikes(u)
    returned = abs(after - before) <= RETURNED * float(np.abs(smooth - before).max())
    d = smooth - (0.5 * (before + after) if returned else before)
    level = 0.0 if returned else after - before
    amplitude = float(np.abs(d).max())
    moving = np.flatnonzero(np.abs(d - level) > BAND * amplitude)
    away = np.flatnonzero(np.abs(d) > BAND * amplitude)
    if len(away) == 0 or len(moving) == 0:
        return None
    first, last = int(away[0]), int(moving[-1])
    at_trim = np.flatnonzero(np.abs(smooth[: first + 1] - before) <= _LEAVING * amplitude)
    start_s = float(t[at_trim[-1]] if len(at_trim) else t[0])
    over = min(last + 1, len(t) - 1)
    arrival_s = 0.5 * float(t[over] + t[over - 1])
    steps = _steps(t, d, (first, last if returned else over), amplitude, level, arrival_s)
    stepped = _is_stepped(t, d, steps)
    kind = _name(t, steps, stepped) if returned and rest is not None else "other"
    last_step_s = max(steps[-1][0], start_s)
    return Movement(kind, start_s, last_step_s, float(t[over]), after, amplitude, quiet, steps, stepped)


def _steps(
    t: FloatArray, d: FloatArray, extent: tuple[int, int], amplitude: float, level: float, arrival_s: float
) -> tuple[tuple[float, float], ...]:
    """Return the lobes on either side of trim as steps, with the onset at half of ``amplitude`` (rad)."""
    # ``t`` and ``d``, shape (n,), are stamps (s) and deviation from trim (rad); ``level`` is the rest's, rad.
    first, last = extent
    out = np.flatnonzero(np.abs(d[first : last + 1]) > BAND * amplitude) + first
    above = d[out] > 0.0
    turns = np.flatnonzero(above[1:] != above[:-1])
    starts = [int(out[0]), *(int(out[k + 1]) for k in turns)]
    ends = [*(int(out[k]) for k in turns), int(out[-1])]
    levels = [median(d[a : b + 1]) for a, b in zip(starts, ends, strict=True)]
    around = [0.0, *levels, *([] if level else [0.0])]
    onsets = []
    for k, (old, new) in enumerate(pairwise(around)):
        back = max(0, starts[0] - 1) if k == 0 else ends[k - 1]
        until = starts[k] if k < len(starts) else min(ends[-1] + 1, len(d) - 1)
        passed = np.flatnonzero((d[back : until + 1] - 0.5 * (old + new)) * np.sign(new - old) >= 0.0)
        j = back + int(passed[0]) if len(passed) else until
        onsets.append(float(0.5 * (t[j] + t[max(j - 1, 0)])))
    steps = list(zip(onsets, around[1:], strict=True))
    if level and arrival_s - onsets[-1] > _EDGE_S:
        steps.append((arrival_s, level))
    elif level:
        steps[-1] = (onsets[-1], level)
    return tuple(steps)


def _name(t: FloatArray, steps: tuple[tuple[float, float], ...], is_stepped: bool) -> InputKind:
    levels = np.array([level for _, level in steps[:-1]])
    lasting = np.diff([onset for onset, _ in steps])
    share = np.abs(levels) / max(float(np.max(np.abs(levels))), 1e-12)
    if len(levels) == 4 and np.min(share) >= _LEAST_LEVEL:
        unit = float(np.sum(lasting)) / 7.0
        step_s = float(np.max(np.diff(t)))
        off = np.abs(lasting - unit * np.array([[3, 2, 1, 1], [1, 1, 2, 3]]))
        forwards, backwards = np.all(off <= _TIMING * unit + step_s, axis=1)
        if forwards or backwards:
            return "3-2-1-1" if forwards and levels[0] < 0.0 else "reverse 3-2-1-1"
    if len(levels) >= _SWEPT_LOBES and not is_stepped:
        return "multisine"
    if len(levels) == 1:
        return "pulse"
    even = len(levels) == 2 and np.min(share) >= _LEAST_LEVEL
    return "doublet" if even and 0.4 <= lasting[0] / max(lasting[1], 1e-9) <= 2.5 else "other"


def _is_stepped(t: FloatArray, d: FloatArray, steps: tuple[tuple[float, float], ...]) -> bool:
    """Return whether the elevator stays on levels between its steps."""
    edges = np.searchsorted(t, [onset for onset, _ in steps])
    on = sum(
        int(np.count_nonzero(np.abs(d[i:j] - level) <= 0.12 * abs(level)))
        for (_, level), i, j in zip(steps, edges, edges[1:], strict=False)
    )
    return on >= _ON_LEVEL * max(1, int(edges[-1] - edges[0]))


FREE_S = (3.0, 8.0)
"""Least and greatest length of the free response, s. Between these limits the free response is as long as the
input."""
_PARTING_S = (0.5, 0.6)
"""Least and greatest length of a rest that separates two movements, s. Between these limits the length is
three quarters of the longest step. The next input may come one second later."""
_SURELY_S = 2.5
"""Length of a rest that always separates two movements, s."""
_BACK = 0.2
"""Largest distance of a short rest from the earlier level, as a share of the amplitude, after which an input
may follow."""
_WAVERING = 0.2
"""Largest spread of a short rest after a movement without levels, as a share of its amplitude. A multisine
itself has slow parts."""
_LEAVES = (0.2, 0.35)
"""Least and greatest deviation of the elevator that ends a free response, as shares of the amplitude. Between
these limits the deviation is five standard deviations of the elevator at rest."""
_LEAVING_S = (1.0, 0.15)
"""Part of a rest that is tested for stillness, in s before the elevator moves. The last moment of the rest
may belong to the next movement."""


@dataclass(frozen=True, slots=True)
class Ended:
    """Event that ended a free response."""

    why: Literal["quiet", "next input", "same input"]
    """Reason: the response lasted long enough, another movement begins, or the earlier movement continues."""
    at_s: float
    """Vehicle time of the end, s."""


class FreeResponse:
    """State of one movement's free response until its end.

    Parameters
    ----------
    before
        Level of the elevator before the movement, rad.
    samples
        Elevator samples, including the newest one. The caller adds the newest sample before each call.
    """

    def __init__(self, movement: Movement, before: float, samples: Samples) -> None:
        self.movement = movement
        self._before = before
        self._samples = samples
        self._away_s: list[float] = []
        duration_s = movement.last_step_s - movement.start_s
        self._end_s = movement.last_step_s + min(max(duration_s, FREE_S[0]), FREE_S[1])

    def take(self, t: float, u: float) -> Ended | None:
        """Take the stamp (s) and elevator (rad) of the newest sample; return None while the response
        continues."""
        least, most = (share * self.movement.amplitude for share in _LEAVES)
        if abs(u - self.movement.trim) <= min(max(5.0 * self.movement.quiet, least), most):
            self._away_s = []
            return Ended("quiet", self._end_s) if t >= self._end_s else None
        self._away_s.append(t)
        if len(self._away_s) < 2:
            return None  # one sample alone is no movement
        left_s = self._away_s[0]
        return Ended("next input" if self._parts(left_s) else "same input", left_s)

    def _parts(self, left_s: float) -> bool:
        """Return whether the rest up to ``left_s`` separates the next movement from this one."""
        movement = self.movement
        rested_s = left_s - movement.over_s
        if rested_s < _parting_s(movement):
            return False
        if rested_s >= _SURELY_S:
            return True
        if abs(movement.trim - self._before) > _BACK * movement.amplitude:
            return False
        from_s = left_s - min(rested_s, _LEAVING_S[0])
        rest = self._samples.since(from_s, self._samples.index(left_s - _LEAVING_S[1]))
        return is_still(rest, (1.0 if movement.is_stepped else _WAVERING) * movement.amplitude)


def _parting_s(movement: Movement) -> float:
    """Return the length of a rest that separates the next movement from this one, s."""
    onsets = [onset for onset, _ in movement.steps]
    longest_s = max((b - a for a, b in pairwise(onsets)), default=0.0)
    return min(max(_PARTING_S[0], 0.75 * longest_s), _PARTING_S[1])
