"""The stamps: one stream earlier or later than the others."""

from dataclasses import replace
from functools import partial

import numpy as np

from advisor.flight.instruments.lateness import lateness_std
from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.variant import Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX, OUTPUTS, SKEWS

BLOCK = "timing"
_STREAMS = (
    ("alpha_skew", "alpha"),
    ("pitch_rate_skew", "q"),
    ("accelerometer_skew", "a_z"),
    ("attitude_skew", "theta"),
)
_MESSAGE_S = 0.012
"""Least skew of a whole message that is named, s: a smaller one resembles too many other effects."""
_FILTERS_S = {"a_z": 0.01, "theta": 0.01}
"""Prior standard deviation, by channel, of the delay of an autopilot's filters relative to the pitch rate,
s."""

_REACH = 2.0
"""Largest delay of an autopilot's own channel, in standard deviations of its prior."""


def filters(flights: PreparedManeuvers) -> Variant:
    """Return the delays of an autopilot's own channels relative to its pitch rate, as nuisance parameters.

    The autopilot's own angle of attack is as late as the estimate assumes (``lateness``): held over an
    interval, and up to 90 ms late.
    """
    std = dict(_FILTERS_S)
    if "alpha" in flights.channels:
        std["alpha"] = lateness_std([flight.outputs["alpha"].t for flight in flights.flights])
    channels = [c for c in flights.channels if c in std]
    return Variant(
        "filters", BLOCK, tuple(f"{c}_late_s" for c in channels), ((0.0,) * len(channels),),
        (1e-3,) * len(channels), tuple((-_REACH * std[c], _REACH * std[c]) for c in channels), 0.0,
        entries=tuple(SKEWS[OUTPUTS.index(c)] for c in channels),
        prior_std=tuple(std[c] for c in channels), is_nuisance=True,
    )  # fmt: skip


def _whole_skew(entry: str, p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the whole skew of a stream, including the delay of a filter."""
    p[:, INDEX[entry]] = values[0]


def _whole_message(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Shift attitude and pitch rate together."""
    for channel in ("q", "theta"):
        p[:, INDEX[SKEWS[OUTPUTS.index(channel)]]] += values[0]


def variants(flights: PreparedManeuvers, least_s: float) -> list[Variant]:
    """Return one skew for each stream, positive is late, and one for a message with attitude and pitch
    rate."""
    found = [
        Variant(
            effect, BLOCK, ("skew_s",), ((0.02,), (-0.02,), (0.1,), (-0.1,)), (1e-3,), ((-0.4, 0.4),),
            least_s, apply_with=partial(_whole_skew, SKEWS[OUTPUTS.index(channel)]), sets=True,
        )
        for effect, channel in _STREAMS
    ]  # fmt: skip
    if _in_one_message(flights):
        skew = next(v for v in found if v.effect == "attitude_skew")
        least_s = max(least_s, _MESSAGE_S)
        whole = replace(
            skew, fixed={"with_pitch_rate": 1.0}, apply_with=_whole_message, smallest=least_s, sets=False
        )
        found.append(whole)
    return found


def _in_one_message(flights: PreparedManeuvers) -> bool:
    """Return whether attitude and pitch rate have equal stamps throughout."""
    return "theta" in flights.channels and all(
        np.array_equal(f.outputs["q"].t, f.outputs["theta"].t) for f in flights.flights
    )
