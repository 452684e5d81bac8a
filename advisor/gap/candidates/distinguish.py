"""Measurements that would distinguish an effect from a cause that looks like it."""

from collections.abc import Sequence

from advisor.gap.effects import EFFECTS


def way_to_distinguish(effect: str, other: str) -> str:
    """Return the measurement that would distinguish two effects; empty when none is known."""
    return EFFECTS[effect].distinguished_by.get(other) or EFFECTS[other].distinguished_by.get(effect, "")


def imitations(name: str, channels: Sequence[str]) -> list[tuple[str, str]]:
    """Return the causes outside the catalogue that look like an effect, each with the measurement that
    distinguishes it."""
    effect = EFFECTS[name]
    alike = [] if effect.imitated_by is None else [effect.imitated_by]
    if effect.imitated_without is not None and effect.imitated_without[0] not in channels:
        alike.append(effect.imitated_without[1:])
    return alike
