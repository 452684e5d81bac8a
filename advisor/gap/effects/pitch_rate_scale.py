"""The pitch rate has a scale error."""

from advisor.gap.kit.effect import ANY, Effect, Variant, always

SCALE = Variant(
    "pitch_rate_scale", "pitch_rate_sensor", ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.01,
    entries=("q_scale",),
)  # fmt: skip

EFFECT = Effect(
    name="pitch_rate_scale",
    block="pitch_rate_sensor",
    keys={"scale": ANY},
    variants=always(SCALE),
    of_one_imu=True,
    said=(
        "The pitch rate reads {scale_percent:.1f} % too much",
        "The pitch rate reads {scale_percent:.1f} % too little",
    ),
)
