"""The result of a lateral estimation: derivatives and modes."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.flight.signals.messages import FloatArray
from advisor.oem.estimate import Estimate
from advisor.oem.flying_qualities import Quality


@dataclass(frozen=True, slots=True)
class LateralModes:
    """Modes of an estimate; an absent one has its reason in ``left_out``."""

    dutch_roll_omega: Quality | None
    """Undamped natural frequency of the Dutch roll, rad/s."""
    dutch_roll_zeta: Quality | None
    """Damping ratio of the Dutch roll."""
    roll_time_constant: Quality | None
    """Time constant of the roll mode, s."""
    spiral_pole: Quality | None
    """Eigenvalue of the spiral, 1/s; positive where the spiral diverges."""
    left_out: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class LateralEstimate(Estimate):
    """The lateral derivatives from one manoeuvre, or from several together, with the modes."""

    COLOUR_IS_SHARED: ClassVar[bool] = False

    common: FloatArray = field(default_factory=lambda: np.zeros((len(SIDE_PARAMETERS),) * 2))
    modes: LateralModes
    nuisances: Mapping[str, tuple[float, float]]
    """Lag or delay by name, to its value and standard deviation, s."""
    flown: tuple[str, ...]
    """Controls of the test: ``aileron``, ``rudder``."""
    scales_with_speed: bool = False
    """Whether the derivatives hold at their air speed and grow with the measured one."""
