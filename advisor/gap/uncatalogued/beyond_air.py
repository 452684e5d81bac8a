"""Names in moving air must explain most of what the air does not: otherwise they only resemble something."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.search.acceptance import LEAST_PRIOR_GAIN
from advisor.gap.search.stage import Stage, added_in

_BESIDE_THE_AIR = 0.5
"""Share that right names take away at least of what the air does not explain."""
_OF_A_RIGHT_MODEL = 2.5
"""What each of its numbers adds to the squared innovations of manoeuvres kept out, together, in those of one
sample: they are fitted to two thirds, of a motion that bends a little (1 to 7 in 25 flights) ..."""
_AT_MOST = 0.3
"""... but that share of what is there without the names: the rest is something."""


def explain_little_beyond_air(stages: Sequence[Stage]) -> bool:
    """Whether names in moving air leave most of what the air does not explain.

    What brings derivatives back to the aircraft file's need not take away anything.
    """
    named = added_in(stages)
    if not named or max(judged.prior_gain for judged in named) >= LEAST_PRIOR_GAIN:
        return False
    removed = removed_beyond_air(stages)
    return removed is not None and removed < _BESIDE_THE_AIR


def removed_beyond_air(stages: Sequence[Stage]) -> float | None:
    """Share of what the air does not explain that the named effects take away, on manoeuvres kept out.

    Measured in the innovations, which are freed of the air, beyond what a right model leaves there for its
    numbers being those of the other manoeuvres. None where that is everything.
    """
    last = stages[-1]
    noise, samples = last.fitted.noise**2, sum(map(len, last.fitted.innovations))
    was, now = (float(np.mean(s.held_out.innovation_square / noise)) - 1.0 for s in (stages[0], last))
    right = min(_OF_A_RIGHT_MODEL * len(last.fitted.point.shared) / samples, _AT_MOST * was)
    return 1.0 - max(now - right, 0.0) / (was - right) if was > 1e-9 else None
