"""Names and forms of quantities for people: symbols, degrees, significant digits."""

import re
from math import isfinite

from advisor.report.quantities import CHANNELS, DEG, Quantity

PARAMETERS = {
    "Z_0": Quantity("Z_0", "deg/s", DEG),
    "Z_alpha": Quantity("Z_α", "1/s"),
    "Z_q": Quantity("Z_q", "-"),
    "Z_delta_e": Quantity("Z_δe", "1/s"),
    "M_0": Quantity("M_0", "deg/s²", DEG),
    "M_alpha": Quantity("M_α", "1/s²"),
    "M_q": Quantity("M_q", "1/s"),
    "M_delta_e": Quantity("M_δe", "1/s²"),
}


def channel(name: str) -> Quantity:
    """Return the symbol and unit of a channel. A channel without an entry keeps its own name and SI."""
    return CHANNELS.get(name, Quantity(name, "SI"))


def without_word(sentence: str) -> str:
    """Return a verdict's sentence without its first word, which stands in large letters already."""
    return re.sub(r"^[A-Z ]+: ", "", sentence)


def headline(sentence: str) -> str:
    """Return the text before the first colon or full stop, for a glance."""
    return re.split(r"[:;.](?:\s|$)", sentence, maxsplit=1)[0]


def percent(value: float | None) -> str:
    """Return a percentage for a glance, without decimals above 10."""
    if value is None or not isfinite(value):
        return "-"
    return f"{value:.1f} %" if abs(value) < 10.0 else f"{value:.0f} %"
