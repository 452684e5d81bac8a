"""How well a parameter must be known: the crew's percentage, and what stands in for it near zero."""

import numpy as np

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.pooling import DERIVATIVES
from advisor.decision.prediction import Prediction
from advisor.flight.messages import FloatArray

NEAR_ZERO = 3.0
"""A derivative is near zero when its whole effect is less than this many times the prediction's tolerance."""

STATIC_SHARE = 2.0
"""The own tolerance of a static or control derivative as a multiple of the prediction's.

Changed alone, it takes 5 to 9 % of M_alpha and 7 to 13 % of Z_alpha to move the response by 5 % of its peak
(three flights of a real autopilot, a research jet), and the frequency goes with the root of the stiffness.
M_delta_e scales the whole response, so that the band of the prediction holds it closer.
"""
DAMPING_SHARE = 4.0
"""The same of a damping derivative, M_q and Z_q.

M_q shares the damping with Z_alpha: on a small aircraft, whose M_q is a third of the sum, 20 % of M_q is
7 % of the damping. Inputs about the short period tell M_q two to four times less well than M_alpha (six
flights of a real autopilot), while the response is known to 1 to 3 % of its peak.
"""
_SHARES = np.array([DAMPING_SHARE if name in ("M_q", "Z_q") else STATIC_SHARE for name in PARAMETERS])

LEAST = 1e-12
"""No tolerance is smaller, in any unit: data without noise leave nothing to be tolerant of."""


def tolerances(theta: FloatArray, prediction: Prediction, plan: CampaignPlan) -> FloatArray:
    """The half-width each parameter's 95 % interval must stay below.

    ``STATIC_SHARE`` or ``DAMPING_SHARE`` times ``plan.tolerance_percent`` of the parameter. For a derivative
    near zero, a share of which is smaller than anything that matters: with δ the change that alone moves
    the predicted response by its tolerance, δ itself at zero, falling to nothing extra at 3·δ. What
    ``plan.tolerance`` says of a parameter stands above all this. No noise enters: a poor manoeuvre must not
    widen what is asked for.

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit; infinite for a derivative on which no response depends.
    """
    size = np.abs(theta)
    tolerance: FloatArray = 0.01 * plan.tolerance_percent * _SHARES * size
    inside = list(DERIVATIVES)
    with np.errstate(divide="ignore"):
        enough = plan.tolerance_percent / prediction.percent_by_derivative
    tolerance[inside] = np.fmax(tolerance[inside], enough - size[inside] / NEAR_ZERO)
    tolerance = np.fmax(tolerance, LEAST)
    for name, value in plan.tolerance.items():
        tolerance[PARAMETERS.index(name)] = value
    return tolerance
