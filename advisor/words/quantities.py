"""Symbol, unit and factor from SI of each channel and parameter, for people."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import degrees

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


CHANNELS: dict[str, Quantity] = {
    "elevator": Quantity("δe", "deg", DEG),
    "alpha": Quantity("α", "deg", DEG),
    "q": Quantity("q", "deg/s", DEG),
    "theta": Quantity("θ", "deg", DEG),
    "a_z": Quantity("a_z", "m/s²"),
    "aileron": Quantity("δa", "deg", DEG),
    "rudder": Quantity("δr", "deg", DEG),
    "p": Quantity("p", "deg/s", DEG),
    "r": Quantity("r", "deg/s", DEG),
    "bank": Quantity("φ", "deg", DEG),
    "a_y": Quantity("a_y", "m/s²"),
    "beta": Quantity("β", "deg", DEG),
    "airspeed": Quantity("V", "m/s"),
    "height": Quantity("h", "m"),
}

PARAMETERS: Mapping[str, Quantity] = {
    "Z_0": Quantity("Z_0", "deg/s", DEG),
    "Z_alpha": Quantity("Z_α", "1/s"),
    "Z_q": Quantity("Z_q", "1"),
    "Z_delta_e": Quantity("Z_δe", "1/s"),
    "M_0": Quantity("M_0", "deg/s²", DEG),
    "M_alpha": Quantity("M_α", "1/s²"),
    "M_q": Quantity("M_q", "1/s"),
    "M_delta_e": Quantity("M_δe", "1/s²"),
}
"""Quantity with symbol and unit for each parameter, by the parameter's name. Only the units of Z_0 and M_0
contain an angle.
"""

_SIDE_UNITS = {"beta": ("β", 2), "p": ("p", 1), "r": ("r", 1), "delta_a": ("δa", 2), "delta_r": ("δr", 2)}
"""Symbol of each variable that a lateral derivative refers to, with the power of 1/s in the unit of a moment
derivative.
"""
SIDE_PARAMETERS: Mapping[str, Quantity] = {
    f"{y}_{x}": Quantity(f"{y}_{symbol}", ("1", "1/s", "1/s²")[power - (y == "Y")])
    for y in "YLN"
    for x, (symbol, power) in _SIDE_UNITS.items()
}
"""Quantity with symbol and unit for each derivative of roll and yaw."""


def symbol(parameter: str) -> str:
    """Return the symbol of a parameter in a sentence for people: ``M_δe``."""
    return parameter.replace("_alpha", "_α").replace("_beta", "_β").replace("_delta_", "_δ")


def channel(name: str) -> Quantity:
    """Return the quantity of a channel. A channel without an entry has its own name and SI unit."""
    return CHANNELS.get(name, Quantity(name, "SI"))
