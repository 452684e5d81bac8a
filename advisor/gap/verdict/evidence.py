"""What an answer is made from: stages, what is left, the air, the floor."""

from dataclasses import dataclass

from advisor.flight.messages import FloatArray
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import Problem
from advisor.gap.search.air import Air
from advisor.gap.search.stage import Stage
from advisor.gap.uncatalogued.airspeed_scale import AirspeedScale
from advisor.gap.uncatalogued.unexplained import Unexplained
from advisor.gap.uncatalogued.weight_check import WeightReading
from advisor.gap.uncatalogued.wind_shear import Shear


@dataclass(frozen=True)
class Evidence:
    """Everything the answer is made from."""

    problem: Problem
    stages: list[Stage]
    unexplained: Unexplained | None
    """Something without a name that is still there."""
    air: Air | None
    floor: FloatArray
    """Shape (channels,): noise as it is where nothing was flown."""
    file_model: HeldOut | None
    """The aircraft file's own parameters, unfitted ..."""
    file_model_with_effects: HeldOut | None
    """... and the same with everything that was named; None where nothing was."""
    constant_speed: HeldOut | None
    """The final model without the change of air speed."""
    airspeed_scale: AirspeedScale | None = None
    """By how much the true air speed is off the one in use, where it is worth saying."""
    shear: Shear | None = None
    """Wind that changes with height: it has no name in the catalogue."""
    weight: WeightReading | None = None
    """What the accelerometer reads of the weight, where it is not all of it."""
