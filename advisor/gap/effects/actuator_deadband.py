"""The surface ignores small commands about a neutral deflection."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.gap.kit.effect import ANY, SMALL_ANGLE_RAD, Effect, Values, Variant
from advisor.gap.records.flights import PreparedManeuvers
from advisor.gap.simulator.layout import INDEX
from advisor.process.arrays import FloatArray

_TRIMS_DIFFER_RAD = 0.005
"""Least range of the trims, rad, at which a dead band about the trim differs from a fixed one."""


def _trims(flights: PreparedManeuvers) -> FloatArray:
    """Return the trim deflection before each manoeuvre, rad, shape (manoeuvres,)."""
    return np.array([flight.u_trim for flight in flights.flights])


def _about_neutral(p: FloatArray, values: Values, flights: PreparedManeuvers) -> None:
    """Set a dead band about one fixed deflection, because crews trim to one edge of the band."""
    p[:, INDEX["half_deadband_rad"]] += values[0]
    p[:, INDEX["neutral_rad"]] = values[1] - _trims(flights)


def _about_trim(p: FloatArray, values: Values, _: PreparedManeuvers) -> None:
    """Set a dead band that moves with the trim, about the command before each manoeuvre."""
    p[:, INDEX["half_deadband_rad"]] += values[0]
    p[:, INDEX["neutral_rad"]] = values[1]


_DEADBAND = Variant(
    "actuator_deadband", "input", ("half_width_rad", "neutral_rad"),
    ((0.0012, 0.0), (0.004, 0.0), (0.015, 0.0), (0.035, 0.0), (0.01, 0.006), (0.01, -0.006)), (2e-4, 2e-4),
    ((0.0, 0.1), (-0.1, 0.1)), SMALL_ANGLE_RAD, apply_with=_about_neutral,
    places=("neutral_rad",),
)  # fmt: skip
DEADBAND_ABOUT_TRIM = replace(
    _DEADBAND,
    starts=((0.0012, 0.0), (0.004, 0.0), (0.015, 0.0), (0.035, 0.0)),
    apply_with=_about_trim,
    fixed={"about_trim": 1.0},
)


def _variants(flights: PreparedManeuvers) -> Sequence[Variant]:
    trims = _trims(flights)
    rest = float(np.median(trims))
    half, (below, above) = _DEADBAND.bounds
    about = replace(
        _DEADBAND,
        starts=tuple((width, rest + place) for width, place in _DEADBAND.starts),
        bounds=(half, (rest + below, rest + above)),
    )
    return (about, DEADBAND_ABOUT_TRIM) if float(np.ptp(trims)) > _TRIMS_DIFFER_RAD else (about,)


EFFECT = Effect(
    name="actuator_deadband",
    block="input",
    keys={"half_width_rad": 0.0, "neutral_rad": ANY, "about_trim": 0.0},
    variants=_variants,
    said=(
        "The real elevator ignores the first {half_width_rad_deg:.2f} deg around neutral",
        "The simulator's elevator ignores {half_width_rad_deg:.2f} deg too much around neutral",
    ),
    said_with={
        "about_trim": "The real elevator ignores the first {half_width_rad_deg:.2f} deg around its trim"
    },
    imitated_by=("lower elevator effectiveness, at one amplitude", "fly two amplitudes"),
    servo={"half_width_rad": ("deadband_rad", 2.0), "neutral_rad": ("neutral_rad", 1.0)},
)
