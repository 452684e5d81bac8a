"""Causes that no fit judges: an offset of α, and the air."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.kinematics import KinematicCheck
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import Problem
from advisor.gap.result import Cause, Value
from advisor.gap.search.acceptance import Judged, least_offset_rad
from advisor.gap.search.indistinguishable import way_to_distinguish
from advisor.gap.verdict.evidence import Evidence
from advisor.gap.verdict.holdout_numbers import without_air

_SCALED_BY = 0.2
"""Share of what a scale error makes of the trimmed angle that an offset may depart from it."""
_GUST_ERROR = 0.25
"""Relative error of a gust's strength: its course is known to low order only."""
_TURBULENCE_ERROR = 0.5
"""The same of turbulence: waves longer than a record pass for its trim. Dryden's air reads 0.5 to 0.7 of its
strength where the scale length takes three seconds and more to fly through, 1.2 where it takes one."""
_GUST_TIME_ERROR_S = 0.1
"""Of a gust's time: the distance between two knots of its course."""


def alpha_bias_cause(
    check: KinematicCheck, named: Sequence[Judged], problem: Problem, gap_after: float, alone: bool
) -> Cause | None:
    """A constant offset of α, from the climb rate: the dynamics cannot tell it from Z_0 and M_0.

    A scale error shifts the trim, too; only what the named one leaves over is an offset. ``gap_after`` is the gap
    of the last model: what the motion alone shows takes nothing off it. ``alone``: nothing else was found
    but air that moves; beside anything else what a mounting leaves is no cause. Its probability is
    decided beside the other causes.
    """
    if not np.isfinite(check.offset.rad) or not check.offset.stays or "alpha" not in problem.channels:
        return None
    least = least_offset_rad(check.offset.std_rad, problem.flights.alpha_is_derived, alone)
    trim = float(np.mean([flight.alpha_trim for flight in problem.flights.flights]))
    scale = sum(float(judged.value[0]) for judged in named if judged.effect == "alpha_scale")
    # The trim was read with the offset taken out already: what a scale makes of it is no offset.
    scaled = scale * trim
    if abs(check.offset.rad) < least or abs(check.offset.rad - scaled) < max(least, _SCALED_BY * abs(scaled)):
        return None
    return Cause(
        "alpha_bias", "alpha_sensor", 0.0, {"bias_rad": Value(check.offset.rad, check.offset.std_rad)},
        ("an offset of the attitude's zero", "steady up- or downwash"),
        "level the attitude reference on the ground; fly in still air", gap_after, True,
    )  # fmt: skip


def air_cause(e: Evidence) -> Cause | None:
    """Turbulence or a gust, with the strength that its course shows."""
    if e.air is None:
        return None
    reference = e.problem.flights.reference_m_s
    gust, stays = e.air.gust, without_air(e.stages[-1].held_out, e.air).mean_square
    gap_after = whole_gap(stays, np.minimum(e.floor, np.sqrt(e.air.mean_square_beyond_air)))
    peak, spread = e.air.gust_angle * reference, e.air.angle_std * reference
    parameters = {"sigma_w_m_s": Value(spread, _TURBULENCE_ERROR * spread)}
    if gust:
        parameters = {
            "amplitude_m_s": Value(peak, _GUST_ERROR * abs(peak)),
            "at_s": Value(e.air.gust_at_s, _GUST_TIME_ERROR_S),
        }
    name, other = ("gust", "turbulence") if gust else ("turbulence", "gust")
    return Cause(
        name, "air", 0.0, parameters, (other,), way_to_distinguish(name, other), gap_after, True,
    )  # fmt: skip
