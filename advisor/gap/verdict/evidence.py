"""What an answer is made from: stages, what is left, the air, the floor."""

from dataclasses import dataclass

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import Problem
from advisor.gap.search.air import Air
from advisor.gap.search.stage import Stage
from advisor.gap.unnamed.leftover import Leftover
from advisor.gap.unnamed.true_speed import TrueSpeed
from advisor.gap.unnamed.weight import Weight
from advisor.gap.unnamed.wind import Shear


@dataclass(frozen=True)
class Evidence:
    """Everything the answer is made from."""

    problem: Problem
    stages: list[Stage]
    leftover: Leftover | None
    """Something without a name that is still there."""
    air: Air | None
    floor: FloatArray
    """Shape (channels,): noise as it is where nothing was flown."""
    file_model: HeldOut | None
    """The aircraft file's own parameters, unfitted ..."""
    file_and_names: HeldOut | None
    """... and the same with everything that was named; None where nothing was."""
    constant_speed: HeldOut | None
    """The final model without the change of air speed."""
    true_speed: TrueSpeed | None = None
    """By how much the true air speed is off the one in use, where it is worth saying."""
    shear: Shear | None = None
    """Wind that changes with height: it has no name in the catalogue."""
    weight: Weight | None = None
    """What the accelerometer reads of the weight, where it is not all of it."""
