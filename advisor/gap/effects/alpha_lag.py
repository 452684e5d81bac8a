"""The angle of attack passes a first-order lag."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect, Need, Variant, least_delay_s
from advisor.gap.records.flights import PreparedManeuvers


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    lag = Variant(
        "alpha_lag", "alpha_sensor", ("lag_s",), ((0.02,), (0.1,)), (1e-3,), ((0.0, 1.0),),
        least_delay_s(flights), entries=("alpha_lag_s",),
    )  # fmt: skip
    return (lag,)


EFFECT = Effect(
    name="alpha_lag",
    block="alpha_sensor",
    # A channel may be ahead of the others where the others are filtered more slowly.
    keys={"lag_s": ANY},
    variants=_variants,
    channel="alpha",
    of_one_imu=True,
    said=(
        "The angle of attack channel lags by {lag_s_ms:.0f} ms",
        "The angle of attack channel is {lag_s_ms:.0f} ms ahead",
    ),
    need=Need("no angle of attack", "AOA_SSA at 50 Hz, or a vane"),
    distinguished_by={
        "alpha_skew": "fly faster steps, or compare the channel's stamps with the vane's",
        "alpha_vane_offset": "fly at two air speeds: only the arm's part is proportional to 1/V",
    },
)
