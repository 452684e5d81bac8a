"""The accelerometer is stamped later or earlier than the other channels."""

from advisor.gap.kit.effect import ANY, UNFILTERED, Effect, Need, skewed

EFFECT = Effect(
    name="accelerometer_skew",
    block="timing",
    keys={"skew_s": ANY},
    variants=skewed("accelerometer_skew", "a_z"),
    channel="a_z",
    said=(
        "The accelerometer is stamped {skew_s_ms:.0f} ms too late",
        "The accelerometer is stamped {skew_s_ms:.0f} ms too early",
    ),
    need=Need("no vertical acceleration", "RAW_IMU at 50 Hz"),
    imitated_by=UNFILTERED,
)
