"""What an effect may be fitted to, and the description every effect gives of itself."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from ..autopilot import Planned
from ..fittings import Fittings
from ..motion import Controls

Sizes = Mapping[str, float]


@dataclass
class Kit:
    """An aircraft on the ground, open for fitting."""

    fittings: Fittings
    trim: Controls
    planned: tuple[Planned, ...]
    duration_s: float
    seed: int
    height_m: float
    trim_alpha: float
    recorded_s: float = 0.0
    """When the first recorded command is flown, where a log is flown again instead of a plan."""

    @property
    def first_s(self) -> float:
        """When the first manoeuvre begins, from which on slow changes count."""
        return self.planned[0].start_s if self.planned else self.recorded_s

    @property
    def middle_s(self) -> float:
        """A time between two manoeuvres about halfway, when changes set in unless told otherwise."""
        if len(self.planned) < 2:
            return 0.5 * self.duration_s
        half = len(self.planned) // 2
        return 0.5 * (self.planned[half - 1].end_s + self.planned[half].manual_from_s)


@dataclass(frozen=True)
class Kind:
    """One kind of effect."""

    block: str
    """Where it enters, by the names of the gap analysis."""
    sizes: dict[str, float]
    """Its parameters with a moderate default each; SI units, angles in rad."""
    fit: Callable[[Kit, Sizes], None] | None = None
    """Fits a component to any engine."""
    airframe: Callable[[Sizes], dict[str, float]] | None = None
    """Fields of the nonlinear airframe that express it; trimmed with them in place."""
    nonlinear_only: bool = False
    """Its component changes the nonlinear airframe's own fields in flight, or adds to its coefficients."""
