"""Accelerometer check: its mean reading is compared with weight and climb, without aerodynamics.

The fit has an offset for every channel and manoeuvre. An offset of more than a seventh of the weight is too
large for an accelerometer's zero error.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from advisor.flight.instruments.evidence import force_against_gravity
from advisor.flight.instruments.measured import pooled
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.decision import SIGMAS
from advisor.words.quantiles import NORMAL_95

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
