"""The angle of attack has a scale error."""

from advisor.gap.kit.effect import ANY, Effect, Need, Variant, always

_SCALE = Variant(
    "alpha_scale", "alpha_sensor", ("scale",), ((0.0,),), (0.002,), ((-0.8, 3.0),), 0.01,
    entries=("alpha_scale",),
)  # fmt: skip

EFFECT = Effect(
    name="alpha_scale",
    block="alpha_sensor",
    keys={"scale": ANY},
    variants=always(_SCALE),
    channel="alpha",
    said=(
        "The angle of attack channel reads {scale_percent:.0f} % too much",
        "The angle of attack channel reads {scale_percent:.0f} % too little",
    ),
    need=Need("no angle of attack", "AOA_SSA at 50 Hz, or a vane"),
    imitated_without=("a_z", "Z_q of the model", "log the accelerometer (RAW_IMU) at 50 Hz"),
)
