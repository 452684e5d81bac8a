"""Result of a lateral estimation: derivatives and modes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.model.axes.lateral import CONTROLS
from advisor.oem.estimate import Estimate
from advisor.oem.flying_qualities import Quality
from advisor.process.arrays import FloatArray


@dataclass(frozen=True, slots=True)
class LateralModes:
    """Modes of a lateral estimate; the reason for a missing mode is in ``left_out``."""

    dutch_roll_omega: Quality | None
    """Undamped natural frequency of the Dutch roll, rad/s."""
    dutch_roll_zeta: Quality | None
    """Damping ratio of the Dutch roll."""
    roll_time_constant: Quality | None
    """Time constant of the roll mode, s."""
    spiral_pole: Quality | None
    """Eigenvalue of the spiral mode, 1/s; positive for a diverging spiral."""
    left_out: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LateralEstimate(Estimate):
    """Lateral derivatives and modes from one manoeuvre, or from several manoeuvres together."""

    COLOUR_IS_SHARED: ClassVar[bool] = False

    common: FloatArray = field(default_factory=lambda: np.zeros((len(SIDE_PARAMETERS),) * 2))
    modes: LateralModes
    nuisances: Mapping[str, tuple[float, float]]
    """Value and standard deviation, s, of each lag or delay, by its name."""
    flown: tuple[str, ...]
    """Controls that the test moves: ``aileron``, ``rudder``."""
    scales_with_speed: bool = False
    """Whether the derivatives belong to a stated air speed and scale with the measured air speed."""

    @property
    def of_prior(self) -> tuple[str, ...]:
        """Names of the derivatives by a control that the test does not move."""
        still = [suffix for suffix, control in CONTROLS.items() if control not in self.flown]
        return tuple(name for name in self.names if any(name.endswith(suffix) for suffix in still))
