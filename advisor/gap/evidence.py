"""What an answer is made from: stages, what is left, the air, the floor."""

from dataclasses import dataclass

import numpy as np

from advisor.flight.messages import FloatArray
from advisor.gap.air import Air
from advisor.gap.coherence import Coherence, unrest
from advisor.gap.holdout import HeldOut
from advisor.gap.problem import Problem
from advisor.gap.waterfall import Stage

VISIBLE = 0.05
"""Gap above the floor from which on there is something to explain."""
DOUBT = 2.5
"""Where the floor is stated, not measured, an unknown cause must exceed it this many times."""
RESTLESS = 2.0
"""Error power while the stick moves over that in quiet, minus 1, from which on it is no noise."""
RESTLESS_IN_MOVING_AIR = 6.0
"""The same when the air moves: it may happen to move more while the stick does."""
LEFT_BY_A_CAUSE = 0.15
"""Share of such excess that a right cause, modelled to low order only, may leave."""
UNEXPLAINED = 0.3
"""Share of the gap that may stay predictable from the motion after a cause was named."""


@dataclass(frozen=True)
class Evidence:
    """Everything the answer is made from."""

    problem: Problem
    stages: list[Stage]
    coherence: Coherence
    air: Air | None
    floor: FloatArray
    file_model: HeldOut | None
    """The aircraft file's own parameters, unfitted."""
    constant_speed: HeldOut | None
    """The final model without the change of air speed."""
    stated: FloatArray
    """Shape (channels,): tolerance of channels filtered before they were recorded, else 0."""


def restless(e: Evidence) -> bool:
    """Whether the error still grows when the stick moves, by more than what was named may leave behind."""
    active, quiet = unrest(e.problem, e.stages[-1].fitted.innovations)
    was, _ = unrest(e.problem, e.stages[0].fitted.innovations)
    quiet = np.maximum(quiet, (DOUBT * e.stated) ** 2)
    rest, total = np.maximum(active / quiet - 1.0, 0.0), np.maximum(was / quiet - 1.0, 0.0)
    share = float(np.mean(rest)) / max(float(np.mean(total)), 1e-12)
    least = RESTLESS_IN_MOVING_AIR if e.air is not None else RESTLESS
    # Every further effect that is needed makes it likelier that none of them is the right one.
    allowed = LEFT_BY_A_CAUSE / max(len(e.stages) - 1, 1)
    return float(np.max(rest)) > least and (share > allowed or len(e.stages) == 1)
