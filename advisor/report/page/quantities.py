"""Channels as people read them: symbol, unit, factor from SI."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees

_DEG = degrees(1.0)


@dataclass(frozen=True, slots=True)
class Quantity:
    """A channel's symbol and unit, and the factor from SI."""

    symbol: str
    unit: str
    factor: float = 1.0

    @property
    def label(self) -> str:
        """For an axis: ``q [deg/s]``."""
        return f"{self.symbol} [{self.unit}]"


QUANTITIES: Mapping[str, Quantity] = {
    "elevator": Quantity("δe", "deg", _DEG),
    "alpha": Quantity("α", "deg", _DEG),
    "q": Quantity("q", "deg/s", _DEG),
    "theta": Quantity("θ", "deg", _DEG),
    "a_z": Quantity("a_z", "m/s²"),
    "airspeed": Quantity("V", "m/s"),
    "height": Quantity("h", "m"),
}
