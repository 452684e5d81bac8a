"""The pitch rate reads too much or too little."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect
from advisor.gap.kit.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers

SCALE = Variant(
    "pitch_rate_scale", "pitch_rate_sensor", ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.01,
    entries=("q_scale",),
)  # fmt: skip


def _variants(_: PreparedManeuvers) -> Sequence[Variant]:
    return (SCALE,)


EFFECT = Effect(
    name="pitch_rate_scale",
    block="pitch_rate_sensor",
    keys={"scale": ANY},
    variants=_variants,
    of_one_imu=True,
    said=(
        "The pitch rate reads {scale_percent:.1f} % too much",
        "The pitch rate reads {scale_percent:.1f} % too little",
    ),
)
