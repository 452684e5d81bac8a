"""Do air speed and accelerometer fit together? Both tell how the path bends; every model lets them differ.

By a few per cent they always do: an indicated air speed is not the true one, and a static port reads what
the wing makes of the pressure there. By more one of the two is wrong.
"""

from dataclasses import dataclass

from advisor.gap.candidates.sensors import TRUE_AIR_SPEED
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import shared_std, worth

_WORTH_SAYING, _WRONG = 0.02, 0.06
"""Relative difference from which on it is said, and from which on something is wrong ..."""
_SIGMAS = 5.0
"""... and the standard deviations it must have ..."""
_SIGMAS_IN_GUSTS = 8.0
"""... to be wrong in moving air: a wave that is met in every manoeuvre is read as a wrong speed, too."""


@dataclass(frozen=True)
class TrueSpeed:
    """By how much the motion's air speed is above the one in use, or the accelerometer reads too high."""

    scale: float
    std: float

    def is_wrong(self, moving_air: bool) -> bool:
        """Whether no air speed indicator of an aircraft is that far off."""
        return abs(self.scale) > max(_WRONG, _SIGMAS_IN_GUSTS * self.std if moving_air else 0.0)

    @property
    def sentence(self) -> str:
        """For the reader of the diagnosis."""
        too = "too high" if self.scale > 0.0 else "too low"
        off = f"{100.0 * self.scale:+.1f} ± {100.0 * self.std:.1f} %"
        return (
            f"The true air speed is {off} off the one in use, as the motion shows; an accelerometer that "
            f"reads as much {too} looks the same: compare the air speed with the ground speed on opposite "
            "headings."
        )


def true_speed_of(problem: Problem, fitted: Fitted) -> TrueSpeed | None:
    """What the fitted model says of it; None where that is next to nothing, or no channel shows it."""
    point = fitted.point
    if TRUE_AIR_SPEED not in point.effects:
        return None
    k = point.effects.index(TRUE_AIR_SPEED)
    at = len(point.derivatives) + sum(len(v) for v in point.values[:k])
    std = float(shared_std(problem, fitted, worth(problem, fitted.innovations))[at])
    scale = float(point.values[k][0])
    return TrueSpeed(scale, std) if abs(scale) > max(_WORTH_SAYING, _SIGMAS * std) else None
