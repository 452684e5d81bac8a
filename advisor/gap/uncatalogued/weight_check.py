"""Accelerometer check: its mean reading is compared with the flight path's, without aerodynamics.

Over a manoeuvre a_z = (V (α̇ − q − G) + a_x sin α)/cos α, with G = (g/V)(cos α cos θ cos φ + sin α sin θ) as
in ``simulate``. The fit has an offset for every channel and manoeuvre. An offset of more than a seventh of
the weight is too large for an accelerometer's zero error.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.decision import SIGMAS
from advisor.process.arrays import FloatArray
from advisor.words.quantiles import NORMAL_95

_NEEDED = ("a_z", "alpha", "theta")
_LEAST_MANEUVERS = 3
"""Record: least number of manoeuvres for an estimate of the scatter."""
_LEVEL_RAD = 0.26
"""Record: largest bank in rad at which the rate of the pitch angle equals the pitch rate."""
_ENDS_S = 0.3
"""Record: length in s of the averages at both ends of an angle."""
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
            f"The accelerometer reads {self.share:.2f} ± {NORMAL_95 * self.std:.2f} of what weight and path "
            "demand: its scale or its zero is off."
        )


def weight_reading(maneuvers: Sequence[Maneuver], airspeed_m_s: float) -> WeightReading | None:
    """Return the share of the weight that the accelerometer reads; None with too few usable manoeuvres.

    ``airspeed_m_s`` is used where no air speed was logged.
    """
    pairs = [p for p in (_means(m, airspeed_m_s) for m in maneuvers) if p is not None]
    if len(pairs) < _LEAST_MANEUVERS:
        return None
    read, due = np.array(pairs).T
    shares = read / due
    return WeightReading(float(np.mean(shares)), float(np.std(shares, ddof=1) / np.sqrt(len(shares))))


def _means(maneuver: Maneuver, airspeed_m_s: float) -> tuple[float, float] | None:
    """Return the mean a_z as measured, and the mean that the flight path requires."""
    channels = maneuver.channels
    if not all(name in channels and len(channels[name]) > 1 for name in _NEEDED):
        return None
    t = channels["a_z"].t
    length = float(t[-1] - t[0])
    if length < 4.0 * _ENDS_S:
        return None

    def on_stamps(name: str, otherwise: float) -> FloatArray:
        found = channels.get(name)
        return np.full(len(t), otherwise) if found is None else np.interp(t, found.t, found.y)

    def rate(y: FloatArray) -> float:
        return float(np.mean(y[t > t[-1] - _ENDS_S]) - np.mean(y[t < t[0] + _ENDS_S])) / (length - _ENDS_S)

    alpha, theta, bank = on_stamps("alpha", 0.0), on_stamps("theta", 0.0), on_stamps("bank", 0.0)
    if np.max(np.abs(bank)) > _LEVEL_RAD:
        return None
    level = np.cos(alpha) * np.cos(theta) * np.cos(bank) + np.sin(alpha) * np.sin(theta)
    curved = np.mean(on_stamps("airspeed", airspeed_m_s)) * (rate(alpha) - rate(theta))
    along = np.mean(on_stamps("a_x", 0.0) * np.sin(alpha))
    due = curved - GRAVITY_M_S2 * float(np.mean(level)) + along
    return float(np.mean(channels["a_z"].y)), float(due / np.mean(np.cos(alpha)))
