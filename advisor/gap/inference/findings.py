"""The findings of a diagnosis: the models of the answer in order, and the circumstances of the flight."""

from dataclasses import dataclass, field

from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.holdout import HeldOut
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.search.air import MovingAir
from advisor.gap.uncatalogued.weight_check import AirspeedScale, WeightReading
from advisor.process.arrays import FloatArray


@dataclass(frozen=True)
class Added:
    """Effect that is added from one model to the next."""

    effect: str
    sole_maneuver: int | None = None
    """Index of the only manoeuvre that determines the effect; None if another manoeuvre could confirm it."""


@dataclass(frozen=True)
class Model:
    """One model of the answer, between the plain and the final model."""

    fitted: EffectFit
    held_out: HeldOut
    added: Added | None = None
    """Effect that leads to the next model; None at the last model."""
    flights: PreparedManeuvers | None = None
    """Flight to which the model is fitted; None for the flight of the findings."""


@dataclass(frozen=True)
class Unexplained:
    """Motion that no known effect explains, and the block in which it arises."""

    block: str
    share: float
    """Probability of the block, given that an effect without a name acts."""
    ranking: tuple[tuple[str, float], ...]
    """Blocks with their scores relative to the likeliest block, which scores 1."""
    note: str = ""
    """A sentence about the law that describes the motion."""


@dataclass(frozen=True)
class Circumstances:
    """Readings of the flight and entries of the aircraft file that belong to every model."""

    weight: WeightReading | None = None
    """Weight that the accelerometer reads; None with too few manoeuvres for a reading."""
    left_aside: tuple[str, ...] = ()
    """Changes in flight of the aircraft file that this flight does not show."""
    speed_is_stated: bool = True
    """Whether the air speed of the file's derivatives is not inferred from the flight."""


@dataclass(frozen=True)
class Findings:
    """All findings from which the numbers and sentences of an answer are made."""

    problem: EffectProblem
    models: tuple[Model, ...]
    """The plain model, then the model of each named effect."""
    unexplained: Unexplained | None
    air: MovingAir | None
    """Moving air, if moving air is the answer."""
    floor: FloatArray
    """Shape (channels,): noise of each channel before and after the input."""
    file_model: HeldOut | None
    """Hold-out of the aircraft file's derivatives without a fit."""
    constant_speed: HeldOut | None
    """Hold-out of the final model with derivatives that do not scale with the air speed."""
    airspeed_scale: AirspeedScale | None
    """Relative excess of the true over the used air speed; None if insignificant."""
    circumstances: Circumstances = field(default_factory=Circumstances)
    without: EffectProblem | None = None
    """Flight next to a user's simulator without effects that the aircraft lacks, if that is the answer."""

    @property
    def last(self) -> Model:
        """Final model of the answer."""
        return self.models[-1]

    @property
    def added(self) -> tuple[Added, ...]:
        """Effects of the answer, in the order of their models."""
        return tuple(model.added for model in self.models if model.added is not None)
