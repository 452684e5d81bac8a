"""The accelerometer is stamped later or earlier than the other channels."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect, Need
from advisor.gap.kit.skew import UNFILTERED, skew_of
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    return (skew_of("accelerometer_skew", "a_z", flights),)


EFFECT = Effect(
    name="accelerometer_skew",
    block="timing",
    keys={"skew_s": ANY},
    variants=_variants,
    channel="a_z",
    said=(
        "The accelerometer is stamped {skew_s_ms:.0f} ms too late",
        "The accelerometer is stamped {skew_s_ms:.0f} ms too early",
    ),
    need=Need("skew_s", "no vertical acceleration", "RAW_IMU at 50 Hz"),
    imitated_by=UNFILTERED,
)
