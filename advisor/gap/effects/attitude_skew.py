"""The attitude, or a message with attitude and pitch rate, is stamped later or earlier than the rest."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.kit.effect import ANY, UNFILTERED, Effect, Need, Values, Variant, skew_of
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, OUTPUTS, SKEWS
from advisor.process.arrays import FloatArray

_MESSAGE_S = 0.012
"""Least skew of a whole message that is named, s: a smaller one resembles too many other effects."""


def _whole_message(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Shift attitude and pitch rate together."""
    for channel in ("q", "theta"):
        p[:, INDEX[SKEWS[OUTPUTS.index(channel)]]] += values[0]


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    skew = skew_of("attitude_skew", "theta", flights)
    if not _in_one_message(flights):
        return (skew,)
    whole = replace(
        skew, fixed={"with_pitch_rate": 1.0}, apply_with=_whole_message,
        smallest=max(skew.smallest, _MESSAGE_S), sets=False,
    )  # fmt: skip
    return (skew, whole)


def _in_one_message(flights: PreparedManeuvers) -> bool:
    """Return whether attitude and pitch rate have equal stamps throughout."""
    return "theta" in flights.channels and all(
        np.array_equal(f.outputs["q"].t, f.outputs["theta"].t) for f in flights.flights
    )


EFFECT = Effect(
    name="attitude_skew",
    block="timing",
    keys={"skew_s": ANY, "with_pitch_rate": 0.0},
    variants=_variants,
    channel="theta",
    said=(
        "The attitude is stamped {skew_s_ms:.0f} ms too late",
        "The attitude is stamped {skew_s_ms:.0f} ms too early",
    ),
    said_with={
        "with_pitch_rate": (
            "Attitude and pitch rate are stamped {skew_s_ms:.0f} ms too late",
            "Attitude and pitch rate are stamped {skew_s_ms:.0f} ms too early",
        )
    },
    need=Need("no attitude", "ATTITUDE at 50 Hz"),
    imitated_by=UNFILTERED,
)
