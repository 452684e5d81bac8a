"""All variants of the effects that the recorded channels allow."""

from advisor.gap.effects import EFFECTS
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers


def variants_for(flights: PreparedManeuvers) -> list[Variant]:
    """Return all variants whose channels were recorded and whose input varied in the flight."""
    possible = [effect for effect in EFFECTS.values() if effect.channel in ("", *flights.channels)]
    return [v for effect in possible for v in effect.variants(flights) if v.needs <= flights.has]
