"""Result of an estimation along an axis: derivatives and modes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

from advisor.oem.estimate import Estimate
from advisor.oem.flying_qualities import Quality
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class AxisEstimate(Estimate):
    """Derivatives and modes of an axis from one manoeuvre, or from several manoeuvres together."""

    COLOUR_IS_SHARED: ClassVar[bool] = False

    common: FloatArray
    modes: Mapping[str, Quality]
    """Quantities of the modes by name, such as ``dutch_roll_omega``, rad/s."""
    modes_left_out: Mapping[str, str] = field(default_factory=dict)
    """Reason why a mode has no values, by its name."""
    nuisances: Mapping[str, tuple[float, float]]
    """Value and standard deviation of each nuisance parameter, by its name."""
    flown: tuple[str, ...]
    """Controls that the test moves."""
    of_still: tuple[str, ...] = ()
    """Names of the derivatives by a control that the test does not move."""
    scales_with_speed: bool = False
    """Whether the derivatives belong to a stated air speed and scale with the measured air speed."""

    @property
    def of_prior(self) -> tuple[str, ...]:
        """Names of the derivatives by a control that the test does not move."""
        return self.of_still
