"""The pitch rate has a constant offset."""

from advisor.gap.kit.effect import ANY, Effect, Variant, always

_LEAST_RAD_S = 0.00175
"""Least bias of the pitch rate that is named, rad/s (0.1 deg/s): the residual after calibration on the
ground."""
_BIAS = Variant(
    "pitch_rate_bias", "pitch_rate_sensor", ("bias_rad_s",), ((0.0,),), (5e-4,), ((-0.5, 0.5),),
    _LEAST_RAD_S, entries=("q_bias",),
)  # fmt: skip

EFFECT = Effect(
    name="pitch_rate_bias",
    block="pitch_rate_sensor",
    keys={"bias_rad_s": ANY},
    variants=always(_BIAS),
    said=(
        "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too high",
        "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too low",
    ),
)
