"""Do air speed and accelerometer fit together? Both tell how the path bends; every model lets them differ.

By a few per cent they always do: an indicated air speed is not the true one, and a static port reads what
the wing makes of the pressure there. By more one of the two is wrong.
"""

from dataclasses import dataclass

import numpy as np

from advisor.gap.candidates.sensors import PROPORTION
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import shared_std, worth

_WORTH_SAYING, _WRONG = 0.02, 0.06
"""Relative difference from which on it is said, and from which on something is wrong ..."""
_SIGMAS = 5.0
"""... and the standard deviations it must have."""


@dataclass(frozen=True)
class Proportion:
    """By how much the accelerometer reads more than the path at the measured air speed demands."""

    scale: float
    std: float

    @property
    def is_wrong(self) -> bool:
        """Whether no air speed indicator of an aircraft is that far off."""
        return abs(self.scale) > _WRONG

    @property
    def sentence(self) -> str:
        """For the reader of the diagnosis."""
        other = "too low" if self.scale > 0.0 else "too high"
        return (
            f"The accelerometer reads {100.0 * self.scale:+.1f} ± {100.0 * self.std:.1f} % against what "
            f"the motion says; an air speed that reads as much {other} looks the same: compare it with the "
            "ground speed on opposite headings."
        )


def proportion_of(problem: Problem, fitted: Fitted) -> Proportion | None:
    """What the fitted model says of it; None where that is next to nothing, or no channel shows it."""
    point = fitted.point
    if PROPORTION not in point.effects:
        return None
    k = point.effects.index(PROPORTION)
    at = len(point.derivatives) + sum(len(v) for v in point.values[:k])
    std = float(shared_std(problem, fitted, worth(problem, fitted.innovations))[at])
    scale = float(point.values[k][0])
    if abs(scale) < max(_WORTH_SAYING, _SIGMAS * std):
        return None
    return Proportion(float(np.round(scale, 4)), std)
