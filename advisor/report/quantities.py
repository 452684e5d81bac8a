"""Channels for people: symbol, unit, factor from SI."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees

from advisor.report.digits import with_half

DEG = degrees(1.0)
"""Degrees in a radian."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A symbol and a unit for people, and the factor from SI."""

    symbol: str
    unit: str
    factor: float = 1.0

    @property
    def label(self) -> str:
        """Label of an axis: ``q [deg/s]``."""
        return f"{self.symbol} [{self.unit}]"

    def with_interval(self, value: float, std: float) -> str:
        """Return an SI value with its 95 % interval, in significant digits: ``-48.3 ± 2.1``."""
        return with_half(value * self.factor, 1.96 * std * self.factor)


CHANNELS: Mapping[str, Quantity] = {
    "elevator": Quantity("δe", "deg", DEG),
    "alpha": Quantity("α", "deg", DEG),
    "q": Quantity("q", "deg/s", DEG),
    "theta": Quantity("θ", "deg", DEG),
    "a_z": Quantity("a_z", "m/s²"),
    "airspeed": Quantity("V", "m/s"),
    "height": Quantity("h", "m"),
}
