"""The mass changes between manoeuvres, with an equal or an independent change of inertia."""

from collections.abc import Sequence
from dataclasses import replace

from advisor.gap.kit.changes_between import ONSET, divide, ramps_and_steps, steps_in
from advisor.gap.kit.effect import ANY, Effect, Need, Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import DERIVATIVES
from advisor.process.arrays import FloatArray

_FORCES, _MOMENTS = DERIVATIVES[:3], DERIVATIVES[3:]
_MASS_AND_INERTIA = Variant(
    "mass_change", "force_equation", ("step", "inertia"), ((0.0, 0.0),), (0.005, 0.005),
    ((-0.9, 3.0), (-0.9, 3.0)), 0.01,
)  # fmt: skip


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    """Return changes of mass with equal change of inertia; a step may change the inertia independently."""
    together = ramps_and_steps("mass_change", "force_equation", flights, divide(*DERIVATIVES))
    inertia = {
        variant.fixed["at_s"]: replace(variant, starts=(), likewise=())
        for variant in steps_in(flights, _MASS_AND_INERTIA, _divided_separately)
    }
    return [
        replace(v, likewise=(*v.likewise, inertia[v.fixed["at_s"]])) if "at_s" in v.fixed else v
        for v in together
    ]


def _divided_separately(p: FloatArray, values: Values, share: FloatArray) -> None:
    """Divide forces by the growth of mass, and moments by the growth of inertia, after the change."""
    for change, growth in zip((divide(*_FORCES), divide(*_MOMENTS)), values, strict=True):
        change(p, growth * share)


EFFECT = Effect(
    name="mass_change",
    block="force_equation",
    keys={**ONSET, "inertia": ANY},
    variants=_variants,
    of_one_flight=True,
    said="The mass changed during the flight",
    need=Need("fewer than three manoeuvres", "repeat the same manoeuvre early and late"),
    distinguished_by={
        "icing": "log fuel and weight; ice moves lift and control by different shares",
        "airspeed_variation": "repeat the same manoeuvre at the same air speed, early and late",
    },
)
