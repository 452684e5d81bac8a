"""The pitch rate is stamped later or earlier than the other channels."""

from advisor.gap.kit.effect import ANY, UNFILTERED, Effect, skewed

EFFECT = Effect(
    name="pitch_rate_skew",
    block="timing",
    keys={"skew_s": ANY},
    variants=skewed("pitch_rate_skew", "q"),
    said=(
        "The pitch rate is stamped {skew_s_ms:.0f} ms too late",
        "The pitch rate is stamped {skew_s_ms:.0f} ms too early",
    ),
    imitated_by=UNFILTERED,
)
