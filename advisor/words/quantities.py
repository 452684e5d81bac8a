"""How numbers and quantities are written: their digits, and their names and units."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import degrees, floor, isfinite, log10
from typing import Literal

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


CLOCK = "minutes:seconds since power-on"
"""Unit and origin of the times that `clock` writes, for headings and help."""


def clock(seconds: float) -> str:
    """Write a time since power-on: ``3:07.5``; ``–`` where the time is not known.

    Minutes continue beyond 60, so that 60 times the minutes plus the seconds is the time in a document.

    Parameters
    ----------
    seconds
        Vehicle time, s since power-on; NaN before the vehicle's clock is heard.
    """
    if not isfinite(seconds):
        return "–"
    minutes, tenths = divmod(round(abs(seconds) * 10.0), 600)
    return f"{'-' if seconds < 0.0 and (minutes or tenths) else ''}{minutes}:{tenths / 10.0:04.1f}"


def stretch(start_s: float, end_s: float) -> str:
    """Write a stretch of vehicle time, s since power-on: ``3:07.5 to 3:19.0``."""
    return f"{clock(start_s)} to {clock(end_s)}"


MOST_DIGITS = 9
"""Largest number of decimals or significant digits of a text. Two numbers have equal texts only if nine
digits agree.
"""


def distinct_texts(
    value: float, limit: float, digits: int = 0, style: Literal["f", "g"] = "f"
) -> tuple[str, str]:
    """Write a number and its limit with ``digits`` digits, and with more digits if both texts would be equal.

    "1.9 s (at least 1.9)" contradicts itself; "1.86 s (at least 1.90)" does not.

    Parameters
    ----------
    digits
        Least number of decimals (``f``) or significant digits (``g``).

    Returns
    -------
    tuple of str
        Texts of the value and of its limit, with equal numbers of digits. The texts are equal only if both
        numbers agree in `MOST_DIGITS` digits.
    """
    for more in (*range(digits, MOST_DIGITS), digits):
        if style == "g":
            texts = significant(value, more), significant(limit, more)
        else:
            texts = f"{value:.{more}f}", f"{limit:.{more}f}"
        if texts[0] != texts[1]:
            break
    return texts


def significant(value: float, digits: int) -> str:
    """Return a number with ``digits`` significant digits. A number of up to 15 places has no exponent:
    ``130``.
    """
    return f"{float(f'{value:.{digits}g}'):.15g}"


def decimals_for(spread: float) -> int:
    """Return the number of decimals, 0 to 6, that show two significant digits of ``spread``."""
    if not (isfinite(spread) and spread > 0.0):
        return 3
    return min(max(1 - floor(log10(spread)), 0), 6)


def signed(value: float, decimals: int) -> str:
    """Return a number with a real minus sign, never "-0"."""
    if not isfinite(value):
        return "-"
    return f"{round(value, decimals) + 0.0:.{decimals}f}".replace("-", "−")


def with_half(value: float, half: float) -> str:
    """Return a number with half its 95 % interval: ``−48.3 ± 2.1``."""
    decimals = decimals_for(half)
    return f"{signed(value, decimals)} ± {signed(half, decimals)}"


def counted(numbers: Sequence[int]) -> str:
    """Return consecutive numbers as ``1 to 9``, and other numbers as a list."""
    if len(numbers) > 2 and numbers[-1] - numbers[0] == len(numbers) - 1:
        return f"{numbers[0]} to {numbers[-1]}"
    return ", ".join(map(str, numbers))


def maneuvers_said(numbers: Sequence[int]) -> str:
    """Return the noun with the numbers of manoeuvres: ``manoeuvre 3``, or ``manoeuvres 1 to 9``."""
    return f"manoeuvre{'s' if len(numbers) > 1 else ''} {counted(numbers)}"


NORMAL_95 = 1.959963984540054
"""Half-width of an interval that holds 95 % of a normal distribution, in standard deviations."""
PAIR_95 = 2.447746830680816
"""Radius of the region that holds 95 % of a normal distribution of two quantities, in standard deviations:
√(-2·ln 0.05)."""
