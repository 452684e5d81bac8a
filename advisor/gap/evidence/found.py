"""The evidence of a diagnosis: stages, unexplained residual, moving air and noise floor."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.known import Effects
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.noise.probes import Probe
from advisor.gap.search.air import MovingAir, SoughtAir
from advisor.gap.search.stage import FoundSets, Stage
from advisor.gap.uncatalogued.airspeed_scale import AirspeedScale
from advisor.gap.uncatalogued.unexplained import Unexplained
from advisor.gap.uncatalogued.weight_check import WeightReading
from advisor.gap.uncatalogued.wind_shear import Shear


@dataclass(frozen=True)
class Evidence:
    """Everything that a diagnosis is made from."""

    problem: EffectProblem
    stages: list[Stage]
    unexplained: Unexplained | None
    """Residual that no named effect explains."""
    air: MovingAir | None
    floor: FloatArray
    """Shape (channels,): noise where nothing was flown."""
    file_model: HeldOut | None
    """Hold-out of the aircraft file's own derivatives, not fitted."""
    file_model_with_effects: HeldOut | None
    """Hold-out of the aircraft file's own derivatives with all named effects; None without effects."""
    constant_speed: HeldOut | None
    """Hold-out of the final model at constant air speed."""
    airspeed_scale: AirspeedScale | None = None
    """Relative excess of the true over the used air speed, where significant."""
    shear: Shear | None = None
    """Wind that changes with height, which is outside the catalogue."""
    weight: WeightReading | None = None
    """The accelerometer's reading of the weight; None where too few manoeuvres tell it."""
    sought_air: SoughtAir = field(default_factory=SoughtAir)
    """The search for moving air, whether or not air was found."""
    laws: Mapping[str, float] = field(default_factory=dict)
    """Gain of the best uncatalogued law of each block; log likelihood minus the price of its parameters."""
    probes: tuple[Probe, ...] = ()
    """Free disturbances in the residual of the last model, likeliest first."""
    sets: FoundSets = field(default_factory=dict)
    known: Effects = field(default_factory=dict)
    """Effects of the aircraft file."""
    left_aside: tuple[str, ...] = ()
    """Changes in flight of the aircraft file that this flight does not show."""
