"""The angle of attack is stamped later or earlier than the other channels."""

from advisor.gap.kit.effect import ANY, Effect, Need, skewed

EFFECT = Effect(
    name="alpha_skew",
    block="timing",
    keys={"skew_s": ANY},
    variants=skewed("alpha_skew", "alpha"),
    channel="alpha",
    of_one_imu=True,
    said=(
        "The angle of attack is stamped {skew_s_ms:.0f} ms too late",
        "The angle of attack is stamped {skew_s_ms:.0f} ms too early",
    ),
    need=Need("no angle of attack", "AOA_SSA at 50 Hz, or a vane"),
)
