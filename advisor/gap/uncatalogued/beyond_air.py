"""The share of the residual beyond moving air that the effects remove, on held-out manoeuvres."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.search.stage import Stage


def removed_beyond_air(stages: Sequence[Stage]) -> float | None:
    """Return the share of the residual beyond moving air that the effects remove, on held-out manoeuvres.

    The innovations contain no moving air. A right model's k parameters come from two of three folds, so its
    squared innovations exceed 1 by 1.5 k over the samples. That is subtracted. None where nothing exceeds it.
    """
    last = stages[-1]
    noise, samples = last.fitted.noise**2, sum(map(len, last.fitted.innovations))
    was, now = (float(np.mean(s.held_out.innovation_square / noise)) - 1.0 for s in (stages[0], last))
    right = 1.5 * len(last.fitted.point.shared) / samples
    return 1.0 - max(now - right, 0.0) / (was - right) if was > right else None
