"""Skew of one channel: stamps that are earlier or later than those of the other channels."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial

from advisor.gap.kit.least import least_delay_s
from advisor.gap.kit.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, OUTPUTS, SKEWS
from advisor.process.arrays import FloatArray

UNFILTERED = (
    "a filter of that channel with an equal delay",
    "log the channel as its sensor reads it, before any filter",
)
"""Cause that looks like a late channel, and the measurement that distinguishes both."""


def skewed(effect: str, channel: str) -> Callable[[PreparedManeuvers], Sequence[Variant]]:
    """Return a function that describes the skew of one channel as the only form of an effect."""
    return partial(_only_skew, effect, channel)


def _only_skew(effect: str, channel: str, flights: PreparedManeuvers) -> Sequence[Variant]:
    return (skew_of(effect, channel, flights),)


def skew_of(effect: str, channel: str, flights: PreparedManeuvers) -> Variant:
    """Return the error of one channel's stamps, s, positive where the channel is late."""
    apply = partial(_whole_skew, SKEWS[OUTPUTS.index(channel)])
    return replace(skew_beyond(effect, least_delay_s(flights)), apply_with=apply, sets=True)


def skew_beyond(effect: str, least_s: float) -> Variant:
    """Return the variant for the skew of any channel, named if at least ``least_s``, s."""
    return Variant(
        effect, "timing", ("skew_s",), ((0.02,), (-0.02,), (0.1,), (-0.1,)), (1e-3,), ((-0.4, 0.4),), least_s
    )


def _whole_skew(entry: str, p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the total skew of a channel, including the delay of a filter."""
    p[:, INDEX[entry]] = values[0]
