"""The vane sits ahead of the centre of gravity, or behind it."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect, Need, Variant, least_arm_m
from advisor.gap.records.flights import PreparedManeuvers

_CHORDS = 4.0
"""Prior standard deviation of a vane's arm over the chord: a vane on a nose boom is four chords ahead."""


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    arm = Variant(
        "alpha_vane_offset", "alpha_sensor", ("arm_m",), ((0.0,),), (0.02,), ((-20.0, 20.0),),
        least_arm_m(flights), entries=("vane_arm_m",),
        prior_std=() if flights.chord_m is None else (_CHORDS * flights.chord_m,),
    )  # fmt: skip
    return (arm,)


EFFECT = Effect(
    name="alpha_vane_offset",
    block="alpha_sensor",
    keys={"arm_m": ANY},
    variants=_variants,
    channel="alpha",
    of_one_imu=True,
    said=(
        "The vane sits {arm_m:.2f} m ahead of the centre of gravity",
        "The vane sits {arm_m:.2f} m behind the centre of gravity",
    ),
    said_beyond=(
        "The vane sits {arm_m:.2f} m further ahead than in the simulator",
        "The vane sits {arm_m:.2f} m further back than in the simulator",
    ),
    need=Need("no angle of attack", "AOA_SSA at 50 Hz, or a vane"),
    distinguished_by={
        "accelerometer_offset": "measure where vane and IMU are: alpha.vane_arm_m, accelerometer.arm_m",
        "alpha_skew": "fly at two air speeds: only the arm's part is proportional to 1/V",
    },
    stated=("alpha", "vane_arm_m"),
    # A vane behind the centre of gravity is rare.
)
