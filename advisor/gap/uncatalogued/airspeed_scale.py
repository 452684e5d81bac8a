"""Do air speed and accelerometer fit together? Both tell how the path bends; every model lets them differ.

By a few per cent they always do: a static port reads what the wing makes of the pressure there. By more one
of the two is wrong; but an air speed may be indicated, and the true one above it in thin air.
"""

from dataclasses import dataclass

from advisor.gap.candidates.sensors import TRUE_AIR_SPEED
from advisor.gap.fitting.fit import Fitted
from advisor.gap.fitting.problem import Problem
from advisor.gap.fitting.uncertainty import effective_samples, shared_std
from advisor.gap.uncatalogued.weight_check import WeightReading

_REPORTED, _WRONG = 0.02, 0.06
"""Relative difference from which on it is said, and from which on something is wrong ..."""
_FELT = 0.03
"""... from which on it is felt that an indicated air speed changes by less than the true one ..."""
_INDICATED = 0.25
"""... which is the most that thin air makes of an indicated air speed, at 4,000 m and above ..."""
_ITS_OWN = 0.5
"""... where the accelerometer does not carry the weight wrongly by this share of it ..."""
_AS_MUCH = 0.05
"""Difference of the two shares at which they are the same: an accelerometer's zero has its part in one."""
_SIGMAS = 5.0
"""... and the standard deviations it must have ..."""
_SIGMAS_IN_GUSTS = 8.0
"""... to be wrong in moving air: a wave that is met in every manoeuvre is read as a wrong speed, too."""


@dataclass(frozen=True)
class AirspeedScale:
    """By how much the motion's air speed is above the one in use, or the accelerometer reads too high."""

    scale: float
    std: float

    def is_wrong(self, moving_air: bool, weight: WeightReading | None) -> bool:
        """Whether no air speed indicator of an aircraft is that far off.

        ``weight``: what the accelerometer reads of it, where that is known.
        """
        least = _INDICATED if self.is_indicated(weight) else _WRONG
        return abs(self.scale) > max(least, _SIGMAS_IN_GUSTS * self.std if moving_air else 0.0)

    def is_indicated(self, weight: WeightReading | None) -> bool:
        """Whether it may be an indicated air speed in thin air, for the accelerometer reads its weight."""
        return weight is not None and self.scale > max(_FELT, (weight.share - 1.0) / _ITS_OWN)

    def is_the_accelerometers(self, weight: WeightReading | None) -> bool:
        """Whether as much is missing of the weight as of what bends the path: no air speed does that."""
        return weight is not None and weight.is_off and abs(self.scale - (weight.share - 1.0)) < _AS_MUCH

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


def true_over_read(found: AirspeedScale | None, weight: WeightReading | None) -> float:
    """How many times the air speed that is read the true one is, where it may be an indicated one; else 1."""
    return 1.0 + found.scale if found is not None and found.is_indicated(weight) else 1.0


def airspeed_scale_of(problem: Problem, fitted: Fitted) -> AirspeedScale | None:
    """What the fitted model says of it; None where that is next to nothing, or no channel shows it."""
    point = fitted.point
    if TRUE_AIR_SPEED not in point.effects:
        return None
    k = point.effects.index(TRUE_AIR_SPEED)
    std = float(
        shared_std(problem, fitted, effective_samples(problem, fitted.innovations))[point.place(k)][0]
    )
    scale = float(point.values[k][0])
    return AirspeedScale(scale, std) if abs(scale) > max(_REPORTED, _SIGMAS * std) else None
