"""The moment equation: curved moments, thrust line, rate of α, a wandering centre of gravity."""

import numpy as np

from advisor.gap.candidates.between import ramps_and_steps, scale
from advisor.gap.data import Flights
from advisor.gap.variant import Variant

BLOCK = "moment_equation"
_THROTTLE_MOVED = 0.02
"""Of its range."""


def variants(flights: Flights) -> list[Variant]:
    """Effects of the block; those between manoeuvres depend on how many were flown."""
    # The thrust's own part of the trim, which does not grow with V², and what the throttle adds to it.
    moved = any(float(np.ptp(f.slow[3])) > _THROTTLE_MOVED for f in flights.flights)
    thrust = ("M_thrust", "M_throttle") if "throttle" in flights.has and moved else ("M_thrust",)
    return [
        Variant(
            "elevator_nonlinearity",
            BLOCK,
            ("M_delta2", "M_delta3"),
            ((0.0, 0.0),),
            (5.0, 100.0),
            ((-2e4, 2e4), (-2e6, 2e6)),
            0.0,
            entries=("M_delta2", "M_delta3"),
        ),
        Variant(
            "nonlinear_pitching_moment",
            BLOCK,
            ("M_alpha2", "M_alpha3"),
            ((0.0, 0.0),),
            (5.0, 50.0),
            ((-5e3, 5e3), (-1e5, 1e5)),
            0.0,
            entries=("M_alpha2", "M_alpha3"),
        ),
        Variant(
            "thrust_moment",
            BLOCK,
            thrust,
            ((0.0,) * len(thrust),),
            (0.05,) * len(thrust),
            ((-100.0, 100.0),) * len(thrust),
            0.0,
            entries=thrust,
        ),
        Variant(
            "alpha_dot",
            BLOCK,
            ("M_alpha_dot",),
            ((0.0,),),
            (0.02,),
            ((-20.0, 0.0),),
            0.0,
            entries=("M_alpha_dot",),
        ),
        *ramps_and_steps("cg_shift", BLOCK, flights, scale("M_alpha")),
    ]
