"""Near the ground the lift grows by a constant share, or the trim alone changes."""

from collections.abc import Sequence

import numpy as np

from advisor.gap.kit.effect import ANY, Effect, Need, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import HEIGHT

_DECAYS_M = (0.1, 50.0)
"""Range of the height over which ground effect decays, m: from a fraction of a small span to more than a
large one."""
_HEIGHT_MOVES_M = 0.2
"""Least change of the height within a manoeuvre that makes it informative, m."""


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    if not any(float(np.ptp(f.slow[HEIGHT])) > _HEIGHT_MOVES_M for f in flights.flights):
        return ()
    flown = float(np.median([np.median(f.slow[HEIGHT]) for f in flights.flights]))
    decays = [float(np.clip(share * flown, *_DECAYS_M)) for share in (0.2, 0.67)]
    return [
        Variant(
            "ground_effect", "force_equation", (lift, "M_h", "scale_m"),
            tuple((0.0, 0.0, scale) for scale in decays), (0.02, 0.2, 0.1),
            (bounds, (-500.0, 500.0), _DECAYS_M), 0.0, entries=(lift, "M_h", "scale_m"),
            needs=frozenset({"height"}), places=("scale_m",),
        )
        for lift, bounds in (("lift_h", (-0.9, 3.0)), ("Z_h", (-50.0, 50.0)))
    ]  # fmt: skip


EFFECT = Effect(
    name="ground_effect",
    block="force_equation",
    keys={"Z_h": ANY, "lift_h": ANY, "M_h": ANY, "scale_m": 0.0},
    variants=_variants,
    of_the_stick=False,
    said="The ground was near enough to change lift or trim",
    need=Need("the height hardly varied", "fly low and high with a range finder"),
    unrecorded=("height", "no height in the log", "fly low and high with a range finder"),
)
