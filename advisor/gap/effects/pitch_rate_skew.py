"""The pitch rate is stamped later or earlier than the other channels."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect
from advisor.gap.kit.skew import UNFILTERED, skew_of
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    return (skew_of("pitch_rate_skew", "q", flights),)


EFFECT = Effect(
    name="pitch_rate_skew",
    block="timing",
    keys={"skew_s": ANY},
    variants=_variants,
    said=(
        "The pitch rate is stamped {skew_s_ms:.0f} ms too late",
        "The pitch rate is stamped {skew_s_ms:.0f} ms too early",
    ),
    imitated_by=UNFILTERED,
)
