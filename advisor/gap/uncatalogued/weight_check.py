"""Checks without aerodynamics: the accelerometer's mean against weight and climb, and its turning against the
air speed.

The fit has an offset for every channel and manoeuvre. An offset of more than a seventh of the weight is too
large for an accelerometer's zero error.

Every model has a nuisance parameter for the difference between air speed and accelerometer. A difference of a
few per cent is normal, because a static port reads a pressure that the wing changes. With a larger difference
one sensor is wrong, unless the air speed is an indicated one in thin air.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.flight.instruments.evidence import force_against_gravity
from advisor.flight.instruments.measured import pooled
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.candidates.known import AIRSPEED, STATIC_PORT
from advisor.gap.decision import SIGMAS
from advisor.gap.fitting.fit import EffectFit
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.fitting.uncertainty import colour_of, covariance_of
from advisor.words.quantities import NORMAL_95

_LEAST_MANEUVERS = 3
"""Record: least number of manoeuvres for an estimate of the scatter."""
_LEAST = 0.15
"""Least deviation of the weight share from 1 that no accelerometer offset explains."""


@dataclass(frozen=True)
class WeightReading:
    """Share of the required specific force that the accelerometer reads."""

    share: float
    std: float

    @property
    def departure(self) -> float:
        """Deviation of the share from 1, over the largest deviation that an accelerometer offset explains."""
        return abs(self.share - 1.0) / max(_LEAST, SIGMAS * self.std)

    @property
    def is_off(self) -> bool:
        """Whether the share differs from 1 by more than an accelerometer offset."""
        return self.departure > 1.0

    @property
    def sentence(self) -> str:
        """Sentence of the diagnosis about the accelerometer's weight reading."""
        return (
            f"The accelerometer reads {self.share:.2f} ± {NORMAL_95 * self.std:.2f} of the force "
            "from weight and path: its scale or its zero is wrong."
        )


def weight_reading(maneuvers: Sequence[Maneuver]) -> WeightReading | None:
    """Return the share of the weight that the accelerometer reads; None with too few usable manoeuvres."""
    readings = [reading for m in maneuvers if (reading := force_against_gravity(m.channels))]
    if len(readings) < _LEAST_MANEUVERS:
        return None
    share = pooled(readings)["a_z_scale"]
    return WeightReading(share.value, share.std)


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
