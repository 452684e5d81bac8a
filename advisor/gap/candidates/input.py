"""Between command and surface: delay, lag, rate limit, play, dead-band."""

from advisor.gap.variant import Variant

BLOCK = "input"
_SMALL_ANGLE = 0.00175  # 0.1 deg


def variants() -> list[Variant]:
    """Effects of the block, one first-order description each."""
    return [
        Variant(
            "transport_delay",
            BLOCK,
            ("delay_s",),
            ((0.02,), (0.1,)),
            (1e-3,),
            ((0.0, 0.5),),
            0.004,
            entries=("delay_s",),
        ),
        Variant(
            "actuator_lag",
            BLOCK,
            ("lag_s",),
            ((0.02,), (0.1,)),
            (1e-3,),
            ((0.0, 1.0),),
            0.004,
            entries=("lag_s",),
        ),
        # Searched as slowness 1/ρ: zero is "no limit", and the cost is smooth there.
        Variant(
            "actuator_rate_limit",
            BLOCK,
            ("rate_rad_s",),
            ((0.4,), (1.2,), (3.0,)),
            (0.02,),
            ((0.0, 30.0),),
            0.05,
            entries=("slowness_s_rad",),
            inverted=True,
        ),
        Variant(
            "actuator_backlash",
            BLOCK,
            ("half_width_rad",),
            ((0.003,), (0.008,), (0.02,)),
            (2e-4,),
            ((0.0, 0.1),),
            _SMALL_ANGLE,
            entries=("half_play_rad",),
            sides=("play_side", (-1.0, 0.0, 1.0)),
        ),
        Variant(
            "actuator_deadband",
            BLOCK,
            ("half_width_rad",),
            ((0.004,), (0.015,)),
            (2e-4,),
            ((0.0, 0.1),),
            _SMALL_ANGLE,
            entries=("half_deadband_rad",),
        ),
    ]
