"""The findings of a diagnosis: the models of the answer in order, and the circumstances of the flight."""

from dataclasses import dataclass, field

from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.known import Effects
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.search.air import MovingAir
from advisor.gap.uncatalogued.airspeed_scale import AirspeedScale
from advisor.gap.uncatalogued.weight_check import WeightReading
from advisor.gap.uncatalogued.wind_shear import Shear


@dataclass(frozen=True)
class Added:
    """The effect that leads from one model to the next."""

    effect: str
    sole_maneuver: int | None = None
    """Index of the only manoeuvre that determines the effect; None where another could confirm it."""


@dataclass(frozen=True)
class Model:
    """One model of the answer."""

    fitted: EffectFit
    held_out: HeldOut
    added: Added | None = None
    """Effect of the next model; None at the last one."""
    flights: PreparedManeuvers | None = None
    """Flight to which the model is fitted; None: that of the findings."""


@dataclass(frozen=True)
class Unexplained:
    """Motion without a name, and the block in which it arises."""

    block: str
    share: float
    """Probability of the block, given that something without a name acts."""
    ranking: tuple[tuple[str, float], ...]
    """Blocks with their scores; the likeliest block scores 1."""
    note: str = ""
    """A sentence about the law that describes the motion."""


@dataclass(frozen=True)
class Circumstances:
    """Readings of the flight and entries of the aircraft file that belong to every model."""

    shear: Shear | None = None
    """Wind that changes with height."""
    weight: WeightReading | None = None
    """The accelerometer's reading of the weight; None where too few manoeuvres tell it."""
    known: Effects = field(default_factory=dict)
    """Effects of the aircraft file."""
    left_aside: tuple[str, ...] = ()
    """Changes in flight of the aircraft file that this flight does not show."""


@dataclass(frozen=True)
class Findings:
    """Everything that the numbers and sentences of an answer are made from."""

    problem: EffectProblem
    models: tuple[Model, ...]
    """The plain model, then the model of each named effect."""
    unexplained: Unexplained | None
    air: MovingAir | None
    """Moving air, where it is the answer."""
    floor: FloatArray
    """Shape (channels,): noise where nothing was flown."""
    file_model: HeldOut | None
    """Hold-out of the aircraft file's own derivatives, not fitted."""
    constant_speed: HeldOut | None
    """Hold-out of the final model at constant air speed."""
    airspeed_scale: AirspeedScale | None
    """Relative excess of the true over the used air speed, where significant."""
    circumstances: Circumstances = field(default_factory=Circumstances)

    @property
    def last(self) -> Model:
        """The final model."""
        return self.models[-1]

    @property
    def added(self) -> tuple[Added, ...]:
        """Effects of the answer, in the order of their models."""
        return tuple(model.added for model in self.models if model.added is not None)
