"""The accelerometer sits ahead of the centre of gravity, or behind it."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.kit.effect import ANY, ARM_M, Effect, Need, Variant, least_arm_m
from advisor.gap.records.flights import PreparedManeuvers

_CHORDS = 1.0
"""Prior standard deviation of an accelerometer's arm over the chord: an IMU lies within the wing's chord."""

ARM = Variant(
    "accelerometer_offset", "accelerometer", ("arm_m",), ((0.0,),), (0.01,), ((-10.0, 10.0),), ARM_M,
    entries=("imu_arm_m",),
)  # fmt: skip


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    std = () if flights.chord_m is None else (_CHORDS * flights.chord_m,)
    return (replace(ARM, smallest=least_arm_m(flights), prior_std=std),)


EFFECT = Effect(
    name="accelerometer_offset",
    block="accelerometer",
    keys={"arm_m": ANY},
    variants=_variants,
    channel="a_z",
    of_one_imu=True,
    said=(
        "The accelerometer sits {arm_m:.2f} m ahead of the centre of gravity",
        "The accelerometer sits {arm_m:.2f} m behind the centre of gravity",
    ),
    said_beyond=(
        "The accelerometer sits {arm_m:.2f} m further ahead than in the simulator",
        "The accelerometer sits {arm_m:.2f} m further back than in the simulator",
    ),
    need=Need("no vertical acceleration", "RAW_IMU at 50 Hz"),
    stated=("accelerometer", "arm_m"),
    # An accelerometer behind the centre of gravity is found less often than a vane ahead of it.
)
