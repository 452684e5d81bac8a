"""Laws outside the catalogue that compete with the effects; the likeliest one makes the answer "unknown"."""

from advisor.gap.kit.effect import Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.uncatalogued.candidate_laws import laws_for, sentence_of
from advisor.process.arrays import FloatArray

AIR_SPEED = Variant(
    "air_speed_scale", "accelerometer", ("scale",), ((0.0,),), (0.002,), ((-0.7, 3.0),), 0.0,
    entries=("speed_scale",), prior_std=(0.15,),
)  # fmt: skip
"""A scale error of the air speed beyond that of a static port. A scale error of the accelerometer looks the
same."""


def laws_of(flights: PreparedManeuvers) -> list[Variant]:
    """Return all laws that the recorded channels allow."""
    speed = [AIR_SPEED] if {"alpha", "a_z"} <= set(flights.channels) else []
    return [*laws_for(flights), *speed]


def sentence_of_law(law: str, values: FloatArray) -> str:
    """Return a sentence about a law with its parameter values, shape (numbers,)."""
    if law == AIR_SPEED.effect:
        percent = 100.0 * float(values[0])
        return f"The motion shows a true air speed {percent:+.0f} % off the measured one."
    return sentence_of(law, values)
