"""Causes that are judged outside the fits: an offset of α, and moving air."""

from collections.abc import Sequence

import numpy as np

from advisor.flight.instruments.kinematics import KinematicCheck
from advisor.gap.evidence.found import Evidence
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.fitting.problem import EffectProblem
from advisor.gap.result import Cause, Value
from advisor.gap.search.acceptance import JudgedAddition, least_offset_rad
from advisor.gap.search.indistinguishable import way_to_distinguish
from advisor.gap.verdict.holdout_numbers import without_air
from advisor.words.quantiles import NORMAL_95

_GUST_ERROR = 0.25
"""Prior: relative error of a gust's strength, whose course is a low-order estimate."""
_TURBULENCE_ERROR = 0.5
"""Prior: relative error of the strength of turbulence. Waves longer than a record pass for its trim. Where
Dryden's scale length takes at least three seconds to fly through, 0.5 to 0.7 of the strength is found. Where
it takes one second, 1.2 is found."""
_GUST_TIME_ERROR_S = 0.1
"""Prior: error of a gust's time, s: the distance between two knots of its course."""


def alpha_bias_cause(
    check: KinematicCheck,
    named: Sequence[JudgedAddition],
    problem: EffectProblem,
    gap_after: float,
    alone: bool,
) -> Cause | None:
    """Return a constant offset of α as a cause, from the climb rate: the dynamics cannot separate it from Z_0
    and M_0.

    A scale error shifts the trim too, so only the rest is an offset. ``gap_after`` is the gap of the last
    model, which an offset does not change. ``alone``: no cause other than moving air was found; otherwise an
    offset within a mounting's tolerance is no cause. The probability is set later.
    """
    if not np.isfinite(check.offset.rad) or not check.offset.stays or "alpha" not in problem.channels:
        return None
    least = least_offset_rad(check.offset.std_rad, problem.flights.alpha_is_derived, alone)
    trim = float(np.mean([flight.alpha_trim for flight in problem.flights.flights]))
    scale = sum(float(judged.value[0]) for judged in named if judged.effect == "alpha_scale")
    # The trim was read without the offset: the effect of a scale error on it is no offset.
    if abs(check.offset.rad) < least or abs(check.offset.rad - scale * trim) < least:
        return None
    return Cause(
        "alpha_bias", "alpha_sensor", 0.0, {"bias_rad": Value(check.offset.rad, check.offset.std_rad)},
        ("an offset of the attitude's zero", "steady up- or downwash"),
        "level the attitude reference on the ground; fly in still air", gap_after, True,
    )  # fmt: skip


def air_cause(e: Evidence) -> Cause | None:
    """Return turbulence or a gust as a cause; None in the air of any flight, and where the aircraft file has
    air of that strength."""
    return beyond_file(e, moving_air_of(e))


def beyond_file(e: Evidence, cause: Cause | None) -> Cause | None:
    """Return a cause; None where the aircraft file has as much of it, within the 95 % interval."""
    if cause is None or cause.effect not in e.known:
        return cause
    name, size = next(iter(cause.parameters.items()))
    is_more = abs(size.value) - NORMAL_95 * size.std > abs(e.known[cause.effect].get(name, 0.0))
    return cause if is_more else None


def moving_air_of(e: Evidence) -> Cause | None:
    """Return turbulence or a gust with the strength of its course; None in the air of any flight."""
    if e.air is None or e.air.is_natural:
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
