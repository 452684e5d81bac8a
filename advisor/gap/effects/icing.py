"""Lift slope and control power decrease together between two manoeuvres, by separate fractions."""

from collections.abc import Sequence

from advisor.gap.kit.changes_between import steps_in
from advisor.gap.kit.effect import ANY, Effect, Need, Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

_ICED = ("Z_alpha", "Z_delta_e", "M_alpha", "M_delta_e")
_ICE = Variant(
    "icing", "force_equation", _ICED, ((0.0,) * 4,), (0.005,) * 4,
    ((-0.9, 0.02), (-0.9, 0.3), (-0.9, 0.3), (-0.9, 0.02)), 0.02,
)  # fmt: skip


def _weaken(p: FloatArray, values: Values, share: FloatArray) -> None:
    for name, value in zip(_ICED, values, strict=True):
        p[:, INDEX[name]] *= 1.0 + value * share


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    return steps_in(flights, _ICE, _weaken) if len(flights) >= 3 else ()


EFFECT = Effect(
    name="icing",
    block="force_equation",
    keys={**dict.fromkeys(_ICED, ANY), "at_s": ANY, "over_s": 0.0},
    variants=_variants,
    of_one_flight=True,
    said="Lift and control weakened during the flight, as by ice",
    need=Need("fewer than three manoeuvres", "repeat the same manoeuvre early and late"),
    distinguished_by={
        "airspeed_variation": "repeat the same manoeuvre at the same air speed, early and late"
    },
)
