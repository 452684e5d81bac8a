"""The stamps: one stream earlier or later than the others."""

from advisor.gap.variant import Variant

_STREAMS = (
    ("alpha_skew", "alpha"),
    ("pitch_rate_skew", "q"),
    ("accelerometer_skew", "a_z"),
    ("attitude_skew", "theta"),
)


def variants(least_s: float) -> list[Variant]:
    """One skew a stream; positive is late."""
    return [
        Variant(
            effect,
            "timing",
            ("skew_s",),
            ((0.02,), (-0.02,), (0.1,), (-0.1,)),
            (1e-3,),
            ((-0.4, 0.4),),
            least_s,
            entries=(f"{channel}_skew_s",),
        )
        for effect, channel in _STREAMS
    ]
