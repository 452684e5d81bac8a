"""Consistency of air speed and accelerometer, which both determine the curvature of the flight path.

Every model has a nuisance parameter for the difference between air speed and accelerometer. A difference of a
few per cent is normal, because a static port reads a pressure that the wing changes. With a larger difference
one sensor is wrong, unless the air speed is an indicated one in thin air.
"""

from dataclasses import dataclass

import numpy as np

from advisor.gap.candidates.nuisances import AIRSPEED, STATIC_PORT
from advisor.gap.decision import SIGMAS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import colour_of, covariance_of
from advisor.gap.uncatalogued.weight_check import WeightReading
from advisor.words.quantiles import NORMAL_95


@dataclass(frozen=True)
class AirspeedScale:
    """Relative excess of the air speed from the motion over the used air speed."""

    scale: float
    std: float

    def is_indicated(self, weight: WeightReading | None) -> bool:
        """Return whether the air speed may be an indicated one in thin air.

        The accelerometer then reads nearly the right weight, and not as much too high as the difference.
        """
        return weight is not None and self.scale > max(0.0, 2.0 * (weight.share - 1.0))

    @property
    def sentence(self) -> str:
        """Sentence of the diagnosis about the air speed's scale."""
        too = "too high" if self.scale > 0.0 else "too low"
        off = f"{100.0 * self.scale:+.1f} ± {100.0 * NORMAL_95 * self.std:.1f} %"
        return (
            f"The motion shows a true air speed {off} off the speed in use. An accelerometer that reads "
            f"as much {too} looks the same: compare air speed and ground speed on opposite headings."
        )


def true_over_read(apart: AirspeedScale | None, weight: WeightReading | None) -> float:
    """Return the ratio of true to read air speed if the read one may be indicated; otherwise 1."""
    return 1.0 + apart.scale if apart is not None and apart.is_indicated(weight) else 1.0


def airspeed_excess(fitted: EffectFit) -> float:
    """Return the relative excess of the true air speed in a fitted model; 0 without a measured air speed."""
    point = fitted.point
    if AIRSPEED not in point.effects:
        return 0.0
    return float(point.values[point.effects.index(AIRSPEED)][0])


def airspeed_scale_of(problem: EffectProblem, fitted: EffectFit) -> AirspeedScale | None:
    """Return the fitted model's difference of air speed and accelerometer; None if insignificant or not
    measured."""
    point, scale = fitted.point, airspeed_excess(fitted)
    if not scale:
        return None
    at = point.place(point.effects.index(AIRSPEED)).start
    cov = covariance_of(problem, fitted, colour_of(problem, fitted))
    std = float(np.sqrt(cov[at, at]))
    return AirspeedScale(scale, std) if abs(scale) > max(NORMAL_95 * STATIC_PORT, SIGMAS * std) else None
