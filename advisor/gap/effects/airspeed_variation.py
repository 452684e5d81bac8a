"""The air speed changes forces and moments, by V² or by another power."""

from collections.abc import Sequence

from advisor.gap.kit.effect import ANY, Effect, Need, Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.oem.prepare import SPEED_CHANGE
from advisor.process.arrays import FloatArray

_TWO_POWERS = 0.1
"""Relative change of the air speed above which moments and lift can have separate powers of the speed."""


def _powers(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set the powers of the air speed for the moments and for the lift."""
    of_moments, of_lift = values
    p[:, INDEX["speed_power"]] += of_lift
    p[:, INDEX["moment_power"]] += of_moments - of_lift


# Mach number, elastic wings or a slipstream: forces grow with another power of the speed than V².
ONE_POWER = Variant(
    "airspeed_variation", "force_equation", ("exponent",), ((0.0,),), (0.02,), ((-6.0, 6.0),), 0.1,
    entries=("speed_power",), needs=frozenset({"airspeed"}),
)  # fmt: skip
# A tail in the wake of the wing or of a propeller: moments grow with another power than the lift.
_OF_EACH = Variant(
    "airspeed_variation", "force_equation", ("exponent_M", "exponent"), ((0.0, 0.0),), (0.02, 0.02),
    ((-6.0, 6.0), (-6.0, 6.0)), 0.1, apply_with=_powers, needs=frozenset({"airspeed"}),
)  # fmt: skip


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    if not _moves(flights):
        return ()
    return (ONE_POWER, _OF_EACH) if flights.speed_moves >= _TWO_POWERS else (ONE_POWER,)


def _moves(flights: PreparedManeuvers) -> bool:
    return flights.speed_moves >= SPEED_CHANGE


EFFECT = Effect(
    name="airspeed_variation",
    block="force_equation",
    keys={"change": ANY, "exponent": ANY, "exponent_M": ANY},
    variants=_variants,
    outside_fits=_moves,
    of_the_stick=False,
    said="The air speed moved by up to {change_percent:.0f} % and the derivatives with it",
    said_with={
        "exponent": "The real forces do not grow with air speed squared, "
        "but with its power {exponent_power:.1f}",
        "exponent_M": "The real moments grow with the air speed's power {exponent_M_power:.1f}, "
        "the lift with {exponent_power:.1f}",
    },
    need=Need("the air speed was constant", "fly at two air speeds"),
    unrecorded=("airspeed", "no air speed in the log", "VFR_HUD at 10 Hz"),
    without_speed=("the air speed reads almost zero", "check the air speed sensor"),
)
