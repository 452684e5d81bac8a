"""Parts that an effect may be fitted to, and the form of an effect."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..autopilot import Planned
from ..fittings import Fittings
from ..motion import Controls

Sizes = Mapping[str, float]


@dataclass
class Kit:
    """An aircraft on the ground, ready for fitting effects."""

    fittings: Fittings
    trim: Controls
    planned: tuple[Planned, ...]
    duration_s: float
    seed: int
    height_m: float
    trim_alpha: float
    recorded_s: float = 0.0
    """Time of the first recorded command, s, where a log is flown again instead of a plan."""

    @property
    def first_s(self) -> float:
        """Begin of the first manoeuvre, s, at which slow changes begin."""
        return self.planned[0].start_s if self.planned else self.recorded_s

    @property
    def middle_s(self) -> float:
        """A time between two manoeuvres about halfway, s, at which changes begin by default."""
        if len(self.planned) < 2:
            return 0.5 * self.duration_s
        half = len(self.planned) // 2
        return 0.5 * (self.planned[half - 1].end_s + self.planned[half].manual_from_s)


@dataclass(frozen=True)
class Kind:
    """One kind of effect."""

    block: str
    """Block in which the effect acts, by the names of the gap diagnosis."""
    sizes: dict[str, float]
    """Parameters with a moderate default each, in SI units, angles in rad."""
    fit: Callable[[Kit, Sizes], None] | None = None
    """Function that fits a component to any engine."""
    airframe: Callable[[Sizes], dict[str, float]] | None = None
    """Fields of the nonlinear airframe that express the effect. The trim includes them."""
    nonlinear_only: bool = False
    """Whether the component changes the nonlinear airframe's own fields in flight, or adds to its
    coefficients."""
