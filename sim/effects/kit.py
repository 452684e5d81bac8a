"""Parts of an aircraft to which an effect is added, and the form of an effect."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..autopilot import Planned
from ..fittings import Fittings
from ..motion import Controls

Sizes = Mapping[str, float]


@dataclass
class Kit:
    """An aircraft before the flight, to which effects are added."""

    fittings: Fittings
    trim: Controls
    planned: tuple[Planned, ...]
    duration_s: float
    seed: int
    height_m: float
    trim_alpha: float
    recorded_s: float = 0.0
    """Time of the first recorded command, s, if a log is flown again."""

    @property
    def first_s(self) -> float:
        """Begin of the first manoeuvre, s, at which slow changes begin."""
        return self.planned[0].start_s if self.planned else self.recorded_s

    @property
    def middle_s(self) -> float:
        """Time between two manoeuvres near the middle, s, at which changes begin by default."""
        if len(self.planned) < 2:
            return 0.5 * self.duration_s
        half = len(self.planned) // 2
        return 0.5 * (self.planned[half - 1].end_s + self.planned[half].manual_from_s)


@dataclass(frozen=True)
class Kind:
    """One kind of effect, with its component and sizes."""

    block: str
    """Block in which the effect acts, by the names of the gap diagnosis."""
    sizes: dict[str, float]
    """Moderate default of each parameter, in SI units and rad."""
    fit: Callable[[Kit, Sizes], None] | None = None
    """Function that adds a component to any engine."""
    airframe: Callable[[Sizes], dict[str, float]] | None = None
    """Function that returns fields of the nonlinear airframe for the effect. The trim includes these
    fields."""
    nonlinear_only: bool = False
    """Whether the component changes the nonlinear airframe's own fields in flight, or adds to its
    coefficients."""
