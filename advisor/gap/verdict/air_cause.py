"""Moving air as a cause, with the strength of its likeliest course."""

import numpy as np

from advisor.gap.candidates.distinguish import way_to_distinguish
from advisor.gap.fitting.measure import whole_gap
from advisor.gap.inference.findings import Findings
from advisor.gap.result import Cause, Value
from advisor.gap.verdict.holdout_numbers import without_air

_GUST_ERROR = 0.25
"""Prior: relative error of a gust's strength, whose course is a low-order estimate."""
_TURBULENCE_ERROR = 0.5
"""Prior: relative error of the strength of turbulence. Waves longer than a record pass for its trim. Where
Dryden's scale length takes at least three seconds to fly through, 0.5 to 0.7 of the strength is found. Where
it takes one second, 1.2 is found."""
_GUST_TIME_ERROR_S = 0.1
"""Prior: error of a gust's time, s: the distance between two knots of its course."""


def moving_air_of(e: Findings) -> Cause | None:
    """Return turbulence or a gust with the strength of its course; None where the air is not the answer."""
    if e.air is None:
        return None
    reference = e.problem.flights.reference_m_s
    gust, stays = e.air.gust, without_air(e.last.held_out, e.air).mean_square
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
