"""Effects that the data cannot distinguish, exactly or nearly, and what would distinguish them."""

from collections.abc import Sequence

from advisor.gap.decision import LEAST_GAIN
from advisor.gap.effects import EFFECTS
from advisor.gap.search.acceptance import JudgedAddition


def way_to_distinguish(effect: str, other: str) -> str:
    """Return what would distinguish two effects; empty when nothing particular is known."""
    return EFFECTS[effect].distinguished_by.get(other) or EFFECTS[other].distinguished_by.get(effect, "")


def imitations(name: str, channels: Sequence[str]) -> list[tuple[str, str]]:
    """Return the causes outside the catalogue that look like an effect, each with what distinguishes it."""
    effect = EFFECTS[name]
    alike = [] if effect.imitated_by is None else [effect.imitated_by]
    if effect.imitated_without is not None and effect.imitated_without[0] not in channels:
        alike.append(effect.imitated_without[1:])
    return alike


def indistinguishable_from(
    best: JudgedAddition, others: Sequence[JudgedAddition], channels: Sequence[str]
) -> tuple[tuple[str, ...], str]:
    """Return the effects that explain the data as well as ``best``, and what would distinguish them."""
    least = max(best.gain - LEAST_GAIN, 0.0)
    names = [j.effect for j in others if j.effect != best.effect and j.gain > least]
    ways = []
    for name in names:
        found = way_to_distinguish(best.effect, name)
        if found:
            ways.append(found)
    for looks, way in imitations(best.effect, channels):
        names.append(looks)
        ways.append(way)
    if names and not ways:
        ways.append("fly more manoeuvres, with another time unit and another amplitude")
    return tuple(names), "; ".join(dict.fromkeys(ways))
