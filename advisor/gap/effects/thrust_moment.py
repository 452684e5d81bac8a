"""Thrust makes a pitching moment, with or without a lag behind the throttle."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.kit.effect import ANY, Effect, Need, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import THROTTLE

THROTTLE_MOVES = 0.02
"""Least change of the throttle within a manoeuvre that makes it informative, as a share of its range."""
AT_ONCE = Variant(
    "thrust_moment", "moment_equation", ("M_throttle",), ((0.0,),), (0.05,), ((-100.0, 100.0),), 0.0,
    entries=("M_throttle",), needs=frozenset({"throttle"}),
)  # fmt: skip
BEHIND = replace(
    AT_ONCE, names=("M_throttle", "lag_s"), starts=((0.0, 0.3), (0.0, 1.0)), steps=(0.05, 0.02),
    bounds=((-100.0, 100.0), (0.0, 5.0)), entries=("M_throttle", "engine_lag_s"), places=("lag_s",),
)  # fmt: skip


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    moves = any(float(np.ptp(f.slow[THROTTLE])) > THROTTLE_MOVES for f in flights.flights)
    return (AT_ONCE, BEHIND) if moves else ()


EFFECT = Effect(
    name="thrust_moment",
    block="moment_equation",
    # The last three are those of the propeller, a nuisance of every model.
    keys={"M_throttle": ANY, "lag_s": 0.0, "M_thrust": ANY, "washed_share": ANY, "blown_share": ANY},
    variants=_variants,
    of_the_stick=False,
    said="Thrust pitches the real aircraft: its line misses the centre of gravity",
    said_with={"lag_s": "Thrust pitches the real aircraft, {lag_s_ms:.0f} ms behind the throttle"},
    need=Need("the throttle did not move", "fly at two air speeds"),
    unrecorded=("throttle", "no throttle in the log", "VFR_HUD at 10 Hz"),
)
