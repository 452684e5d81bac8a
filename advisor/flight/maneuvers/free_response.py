"""Free response after a movement of the elevator: its length, and the event that ends it."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from advisor.flight.maneuvers.movement import Movement, is_still
from advisor.flight.signals.samples import Samples

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
