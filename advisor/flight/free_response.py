"""The free response after a movement of the elevator: how long it lasts, and what ends it."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

from advisor.flight.movement import Movement
from advisor.flight.rest import is_still
from advisor.flight.samples import Samples

_FREE_S = (3.0, 8.0)
"""Free response: as long as the input, but within these."""
_PARTING_S = (0.5, 0.6)
"""A rest parts two movements if it lasts for three quarters of the longest step, but within these. The next
input may come one second later."""
_SURELY_S = 2.5
"""A rest this long parts two movements however it wavers."""
_BACK = 0.2
"""After a shorter rest within this share of the amplitude from the level before, the next input may come."""
_WAVERING = 0.2
"""A shorter rest after a movement without levels must be still against this share of its amplitude: a
multisine has gentle parts of its own."""
_LEAVES = (0.2, 0.35)
"""A free response ends where the elevator moves by five standard deviations of its rest, but
within these shares of the amplitude."""
_LEAVING_S = (1.0, 0.15)
"""The part of a rest that is asked whether it is still, s before the elevator leaves: the last
moment may be its setting out."""


@dataclass(frozen=True, slots=True)
class Ended:
    """What ended a free response."""

    why: Literal["quiet", "next input", "same input"]
    """It has lasted long enough, another movement begins, or the movement before goes on."""
    at_s: float
    """Stamp of its end, s."""


class FreeResponse:
    """Awaits the end of the free response of one movement.

    Parameters
    ----------
    movement
        The movement that has come to rest.
    before
        Level of the elevator before the movement, rad.
    samples
        The elevator's samples, to which the newest is always added first.
    """

    def __init__(self, movement: Movement, before: float, samples: Samples) -> None:
        self.movement = movement
        self._before = before
        self._samples = samples
        self._away_s: list[float] = []
        duration_s = movement.last_step_s - movement.start_s
        self._end_s = movement.last_step_s + min(max(duration_s, _FREE_S[0]), _FREE_S[1])

    def take(self, t: float, u: float) -> Ended | None:
        """Take the newest sample, stamp (s) and elevator (rad); None while the response goes on."""
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
        """Return whether the rest until ``left_s`` makes another movement of what follows."""
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
    """Return how long the elevator must rest for what follows to be another movement."""
    onsets = [onset for onset, _ in movement.steps]
    longest_s = max((b - a for a, b in pairwise(onsets)), default=0.0)
    return min(max(_PARTING_S[0], 0.75 * longest_s), _PARTING_S[1])
