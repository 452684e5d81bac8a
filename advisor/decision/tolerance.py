"""How well a parameter must be known: the crew's percentage, and what stands in for it near zero."""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.pooling import DERIVATIVES
from advisor.decision.prediction import Prediction
from advisor.flight.messages import FloatArray

NEAR_ZERO = 3.0
"""A derivative is near zero when its whole effect is less than this many times the prediction's tolerance."""

SHARE = 2.0
"""The own tolerance of a derivative as a multiple of the prediction's.

Changed alone, it takes 5 to 9 % of M_alpha and 7 to 13 % of Z_alpha to move the response by 5 % of its peak
(three flights of a real autopilot, a research jet), and the frequency goes with the root of the stiffness.
M_delta_e scales the whole response, so that the band of the prediction holds it closer.
"""
LEAST = 1e-12
"""No tolerance is smaller, in any unit: data without noise leave nothing to be tolerant of."""


def tolerances(theta: FloatArray, prediction: Prediction, plan: CampaignPlan) -> FloatArray:
    """Return the half-width each parameter's 95 % interval must stay below.

    ``SHARE`` times ``plan.tolerance_percent`` of the parameter, or what moves the frequency or the damping
    of the short period by ``plan.tolerance_percent``, whichever is larger. For a derivative near zero, a
    share of which is smaller than anything that matters: with δ the change that alone moves the predicted
    response by its tolerance, δ itself at zero, falling to nothing extra at 3·δ. What ``plan.tolerance``
    says of a parameter stands above all this. No noise enters: a poor manoeuvre must not widen what is
    asked for.

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit; infinite for a derivative on which no response depends.
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
    """Return the change of a derivative, per relative change of the frequency or of the damping that the
    change makes.

    ω² = Z_α·M_q - (1 + Z_q)·M_α and 2·ζ·ω = -(Z_α + M_q): where M_q is a small part of the damping, much of
    M_q makes little difference.
    """
    z_alpha, z_q, m_alpha, m_q = (theta[PARAMETERS.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    damping = abs(z_alpha + m_q)
    stiffness = abs(z_alpha * m_q - (1.0 + z_q) * m_alpha)
    return {"Z_alpha": damping, "M_q": damping, "M_alpha": 2.0 * stiffness}
