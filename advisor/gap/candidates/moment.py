"""The moment equation: nonlinear moments, thrust line, rate of α, a moving centre of gravity."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.gap.candidates.bent import bent
from advisor.gap.candidates.between import ramps_and_steps, shift_moments, shift_stability
from advisor.gap.candidates.variant import Variant
from advisor.gap.records.flights import PreparedManeuvers

BLOCK = "moment_equation"


PROPELLER = Variant(
    "propeller", BLOCK, ("M_thrust", "washed_share", "blown_share"), ((0.0, 0.0, 0.0),),
    (0.05, 0.05, 0.05), ((-100.0, 100.0), (-1.0, 2.0), (-10.0, 10.0)), 0.0,
    entries=("M_thrust", "washed_share", "blown_share"), prior_std=(5.0, 0.5, 3.0), is_nuisance=True,
)  # fmt: skip
"""Nuisance parameters of every model with a measured air speed. The thrust's share of the trim does not grow
with V². An elevator in the propeller's wake meets more than the dynamic pressure of the stream, by thrust
over disk area (Glauert's momentum theory). Thrust is drag, which grows with V², plus the acceleration along
the path. In a light single the wake adds about a fifth of the elevator's power."""


_CURVED_ELEVATOR = Variant(
    "elevator_nonlinearity", BLOCK, ("M_delta2", "M_delta3"), ((0.0, 0.0),), (5.0, 100.0),
    ((-2e4, 2e4), (-2e6, 2e6)), 0.0, entries=("M_delta2", "M_delta3"),
)  # fmt: skip
_CURVED_MOMENT = Variant(
    "nonlinear_pitching_moment", BLOCK, ("M_alpha2", "M_alpha3"), ((0.0, 0.0),), (5.0, 50.0),
    ((-5e3, 5e3), (-1e5, 1e5)), 0.0, entries=("M_alpha2", "M_alpha3"),
)  # fmt: skip


def _without_rate_of_alpha(
    derivatives: FloatArray, effects: Sequence[Variant], speed_m_s: float
) -> FloatArray:
    """Return the change of M_α, M_q, M_δe and the thrust's moment per unit of M_α̇, with M_α̇ α̇ expanded by
    Eq. (1).

    The weight's part of α̇ grows with 1/V, the trimmed lift's with V: together with 1 − V², like the thrust's
    moment.
    """
    z_alpha, z_q, z_delta = derivatives[:3]
    change = [0.0, 0.0, 0.0, -z_alpha, -(1.0 + z_q), -z_delta]
    for effect in effects:
        change += [-GRAVITY_M_S2 / speed_m_s if name == "M_thrust" else 0.0 for name in effect.names]
    return np.array(change)


def variants(flights: PreparedManeuvers) -> list[Variant]:
    """Return the effects of the block; those between manoeuvres depend on how many were flown."""
    return [
        bent(_CURVED_ELEVATOR, flights),
        bent(_CURVED_MOMENT, flights),
        Variant(
            "thrust_moment", BLOCK, ("M_throttle",), ((0.0,),), (0.05,), ((-100.0, 100.0),), 0.0,
            entries=("M_throttle",), needs=frozenset({"throttle"}),
        ),
        Variant(
            "thrust_moment", BLOCK, ("M_throttle", "lag_s"), ((0.0, 0.3), (0.0, 1.0)), (0.05, 0.02),
            ((-100.0, 100.0), (0.0, 5.0)), 0.0, entries=("M_throttle", "engine_lag_s"),
            needs=frozenset({"throttle"}), places=("lag_s",),
        ),
        Variant(
            "alpha_dot", BLOCK, ("M_alpha_dot",), ((0.0,),), (0.02,), ((-20.0, 20.0),), 0.0,
            entries=("M_alpha_dot",), twin=_without_rate_of_alpha,
        ),
        *_moved_weight(flights),
    ]  # fmt: skip


def _moved_weight(flights: PreparedManeuvers) -> list[Variant]:
    """Return a moving centre of gravity, with its effect on all moments or on the stability alone."""
    of_all = ramps_and_steps("cg_shift", BLOCK, flights, shift_moments)
    alone = ramps_and_steps("cg_shift", BLOCK, flights, shift_stability)
    return [
        replace(moments, likewise=(_marked(stability), *moments.likewise))
        for moments, stability in zip(of_all, alone, strict=True)
    ]


def _marked(stability: Variant) -> Variant:
    return replace(stability, fixed={**stability.fixed, "stability_only": 1.0})
