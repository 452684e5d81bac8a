"""Do air speed and accelerometer fit together? Both tell how the path bends; every model lets them differ.

By a few per cent they always do: a static port reads what the wing makes of the pressure there, and an air
speed may be indicated, and the true one above it in thin air.
"""

from dataclasses import dataclass

from advisor.gap.candidates.sensors import TRUE_AIR_SPEED
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import shared_std, worth

_WORTH_SAYING = 0.02
"""Relative difference from which on it is said ..."""
_SIGMAS = 5.0
"""... and the standard deviations it must have."""


@dataclass(frozen=True)
class TrueSpeed:
    """By how much the motion's air speed is above the one in use, or the accelerometer reads too high."""

    scale: float
    std: float

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
    std = float(shared_std(problem, fitted, worth(problem, fitted.innovations))[point.place(k)][0])
    scale = float(point.values[k][0])
    return TrueSpeed(scale, std) if abs(scale) > max(_WORTH_SAYING, _SIGMAS * std) else None
