"""Effects in moving air: they must explain most of the residual that moving air does not explain."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.search.acceptance import LEAST_PRIOR_GAIN
from advisor.gap.search.stage import Stage, added_in

_BESIDE_THE_AIR = 0.5
"""Least share of the residual beyond moving air that the right effects remove."""
_OF_A_RIGHT_MODEL = 2.5
"""Excess of the squared innovations on held-out manoeuvres per shared parameter of a right model, over all
samples, in units of one sample. Two thirds of the manoeuvres are fitted, and the motion is slightly
nonlinear: 1 to 7 was found in 25 flights."""
_AT_MOST = 0.3
"""Largest such excess, as a share of the excess without effects. More is an unexplained residual."""


def explain_little_beyond_air(stages: Sequence[Stage]) -> bool:
    """Return whether effects in moving air leave most of the residual that moving air does not explain.

    Effects with a large prior gain need not remove any residual.
    """
    named = added_in(stages)
    if not named or max(judged.prior_gain for judged in named) >= LEAST_PRIOR_GAIN:
        return False
    removed = removed_beyond_air(stages)
    return removed is not None and removed < _BESIDE_THE_AIR


def removed_beyond_air(stages: Sequence[Stage]) -> float | None:
    """Return the share of the residual beyond moving air that the effects remove, on held-out manoeuvres.

    The innovations contain no moving air. The excess of a right model, whose parameters come from the other
    manoeuvres, is subtracted. None where that excess is everything.
    """
    last = stages[-1]
    noise, samples = last.fitted.noise**2, sum(map(len, last.fitted.innovations))
    was, now = (float(np.mean(s.held_out.innovation_square / noise)) - 1.0 for s in (stages[0], last))
    right = min(_OF_A_RIGHT_MODEL * len(last.fitted.point.shared) / samples, _AT_MOST * was)
    return 1.0 - max(now - right, 0.0) / (was - right) if was > 1e-9 else None
