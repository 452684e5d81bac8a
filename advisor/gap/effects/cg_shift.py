"""The centre of gravity moves between manoeuvres, so that all moments or the stability alone change."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.kit.changes_between import ONSET, ramps_and_steps, shift_moments, shift_stability
from advisor.gap.kit.effect import Effect, Need, Variant
from advisor.gap.records.flights import PreparedManeuvers


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    of_all = ramps_and_steps("cg_shift", "moment_equation", flights, shift_moments)
    alone = ramps_and_steps("cg_shift", "moment_equation", flights, shift_stability)
    return [
        replace(moments, likewise=(_marked(stability), *moments.likewise))
        for moments, stability in zip(of_all, alone, strict=True)
    ]


def _marked(stability: Variant) -> Variant:
    return replace(stability, fixed={**stability.fixed, "stability_only": 1.0})


_WEIGHT = "log fuel and weight; ice moves lift and control by different shares"
EFFECT = Effect(
    name="cg_shift",
    block="moment_equation",
    keys={**ONSET, "stability_only": 0.0},
    variants=_variants,
    of_one_flight=True,
    said="The centre of gravity moved during the flight",
    need=Need("fewer than three manoeuvres", "repeat the same manoeuvre early and late"),
    distinguished_by={
        "mass_change": _WEIGHT,
        "icing": _WEIGHT,
        "airspeed_variation": "repeat the same manoeuvre at the same air speed, early and late",
    },
)
