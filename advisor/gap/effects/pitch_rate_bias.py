"""The pitch rate has a constant offset."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers

_LEAST_RAD_S = 0.00175
"""Least bias that is named, rad/s (0.1 deg/s): the rest after a gyro was set to zero on the ground."""
_BIAS = Variant(
    "pitch_rate_bias", "pitch_rate_sensor", ("bias_rad_s",), ((0.0,),), (5e-4,), ((-0.5, 0.5),),
    _LEAST_RAD_S, entries=("q_bias",),
)  # fmt: skip


def _variants(_: PreparedManeuvers) -> Sequence[Variant]:
    return (_BIAS,)


EFFECT = Effect(
    name="pitch_rate_bias",
    block="pitch_rate_sensor",
    keys={"bias_rad_s": ANY},
    variants=_variants,
    said=(
        "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too high",
        "The pitch rate reads {bias_rad_s_deg:.2f} deg/s too low",
    ),
)
