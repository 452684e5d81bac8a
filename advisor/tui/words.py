"""How quantities are called and written for people: symbols, degrees, digits that mean something."""

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
    """How a channel is written; one without an entry keeps its own name and SI."""
    return CHANNELS.get(name, Quantity(name, "SI"))


def without_word(sentence: str) -> str:
    """A verdict's sentence without the word before it, where the word stands in large letters already."""
    return re.sub(r"^[A-Z ]+: ", "", sentence)


def headline(sentence: str) -> str:
    """What comes before the first colon or full stop: enough for a glance."""
    return re.split(r"[:;.](?:\s|$)", sentence, maxsplit=1)[0]


def percent(value: float | None) -> str:
    """A percentage for a glance: no decimals above 10."""
    if value is None or not isfinite(value):
        return "-"
    return f"{value:.1f} %" if abs(value) < 10.0 else f"{value:.0f} %"
