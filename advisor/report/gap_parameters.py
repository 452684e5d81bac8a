"""Derivatives of simulator and flight, ``M_α −44.6 → −34.3 ± 0.7 (−23 %)``."""

from collections.abc import Sequence

from advisor.gap.result import ComparedDerivative
from advisor.words.digits import decimals_for, signed, with_half
from advisor.words.quantities import PARAMETERS


def changed(one: ComparedDerivative) -> str:
    """Return one derivative: the simulator's value, the flight's with half its 95 % interval, the change."""
    quantity = PARAMETERS[one.name]
    given, found, half = (quantity.factor * x for x in (one.given, one.found.value, one.half))
    share = "" if one.percent is None else f" ({signed(one.percent, 0)} %)"
    if one.percent is not None and one.percent > 0.0:
        share = f" (+{signed(one.percent, 0)} %)"
    return f"{quantity.symbol} {signed(given, decimals_for(half))} → {with_half(found, half)}{share}"


def changes(derivatives: Sequence[ComparedDerivative]) -> list[str]:
    """Return a line for each derivative that differs, then one with those that agree."""
    agree = [PARAMETERS[one.name].symbol for one in derivatives if not one.differs]
    lines = [changed(one) for one in derivatives if one.differs]
    return [*lines, *([f"{', '.join(agree)} agree{'s' if len(agree) == 1 else ''}"] if agree else [])]
