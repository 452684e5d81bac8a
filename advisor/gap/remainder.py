"""A name must explain most of the gap: what leaves much of it only resembles what is there."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.leftover import Leftover, placed
from advisor.gap.measure import gap_of
from advisor.gap.problem import Problem
from advisor.gap.waterfall import Stage

_MOST = 0.5
"""Share of the gap that right names may leave, in still air, or else ..."""
_SEEN = 0.3
"""... this gap: an effect that is not in the catalogue leaves more beside its likeness."""


def remainder(problem: Problem, stages: Sequence[Stage], floor: FloatArray) -> Leftover | None:
    """What is there, where the named effects leave too much of the gap on manoeuvres kept out.

    All of the gap is placed: the names took up a part that was not theirs.

    ``floor`` is the noise of each channel, shape (channels,).
    """
    before, after = (float(np.mean(gap_of(s.held_out.mean_square, floor))) for s in (stages[0], stages[-1]))
    if len(stages) < 2 or after < max(_SEEN, _MOST * before):
        return None
    return placed(problem, stages[0].fitted)
