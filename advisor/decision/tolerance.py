"""Tolerance of each parameter: the crew's percentage, or its replacement near zero."""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.pooling import DERIVATIVES
from advisor.decision.prediction import Prediction
from advisor.process.arrays import FloatArray

NEAR_ZERO = 3.0
"""Multiple of the prediction's tolerance below which a derivative's whole effect is near zero."""

SHARE = 2.0
"""Tolerance of a derivative as a multiple of the prediction's tolerance.

An error of 5 to 9 % in M_alpha alone moves the response by 5 % of its peak; in Z_alpha, 7 to 13 %. The
percentages are from three flights of a real autopilot and from a research jet. The frequency changes with
the square root of the stiffness. M_delta_e scales the whole response, so the prediction's band limits its
error more strictly.
"""
LEAST = 1e-12
"""Least tolerance, in any unit. Data without noise would otherwise give a tolerance of zero."""


def tolerances(theta: FloatArray, prediction: Prediction, plan: CampaignPlan) -> FloatArray:
    """Return the tolerance for each parameter's 95 % half-width.

    The tolerance is the larger of two numbers. The first number is ``SHARE`` times ``plan.tolerance_percent``
    of the parameter. The second is the change that alters the short period's frequency or damping by
    ``plan.tolerance_percent``. For a derivative near zero, a share of its value would be smaller than any
    relevant change. Near zero the tolerance is δ, the change that alone moves the response by its tolerance.
    δ fades linearly up to 3·δ. An entry of ``plan.tolerance`` replaces the computed tolerance. Noise is not
    included, because a bad manoeuvre must not widen a tolerance.

    Returns
    -------
    FloatArray
        Shape (8,): tolerance in each parameter's unit. The tolerance is infinite for a derivative without
        effect on the response.
    """
    size = np.abs(theta)
    tolerance: FloatArray = 0.01 * plan.tolerance_percent * SHARE * size
    for name, change in _moving_the_short_period(theta).items():
        k = PARAMETERS.index(name)
        tolerance[k] = np.fmax(tolerance[k], 0.01 * plan.tolerance_percent * change)
    inside = list(DERIVATIVES)
    with np.errstate(divide="ignore"):
        enough = plan.tolerance_percent / prediction.percent_by_derivative
    tolerance[inside] = np.fmax(tolerance[inside], enough - size[inside] / NEAR_ZERO)
    tolerance = np.fmax(tolerance, LEAST)
    for name, value in plan.tolerance.items():
        tolerance[PARAMETERS.index(name)] = value
    return tolerance


def _moving_the_short_period(theta: FloatArray) -> Mapping[str, float]:
    """Return the change of each derivative for a relative change of 1 in frequency or damping."""
    # ω² = Z_α·M_q - (1 + Z_q)·M_α and 2·ζ·ω = -(Z_α + M_q).
    z_alpha, z_q, m_alpha, m_q = (theta[PARAMETERS.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    damping = abs(z_alpha + m_q)
    stiffness = abs(z_alpha * m_q - (1.0 + z_q) * m_alpha)
    return {"Z_alpha": damping, "M_q": damping, "M_alpha": 2.0 * stiffness}
