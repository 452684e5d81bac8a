"""How well a parameter must be known: the crew's percentage, and what stands in for it near zero."""

import numpy as np

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.pooling import information_of
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate

NEAR_ZERO = 3.0
"""A parameter is near zero when its whole effect on the response is less than this many times the noise."""

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


def tolerances(theta: FloatArray, first: Estimate, plan: CampaignPlan) -> FloatArray:
    """The half-width each parameter's 95 % interval must stay below.

    ``STATIC_SHARE`` or ``DAMPING_SHARE`` times ``plan.tolerance_percent`` of the parameter. For one near
    zero, a share of which is smaller than anything that matters: with δ the change that moves the response
    by as much as the noise, δ itself at zero, falling to nothing extra at 3·δ. Z_0 and M_0, which hold
    the trim, may also be wrong by what shifts the trim by as much as the noise of a measured angle of
    attack. What ``plan.tolerance`` says of a parameter stands above all this.

    Noise and response are those of the ``first`` usable manoeuvre: a bolder one shows more, and must
    not move the goal while it is being approached.

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit.
    """
    size = np.abs(theta)
    tolerance = np.fmax(
        0.01 * plan.tolerance_percent * _SHARES * size,
        unnoticeable_change(first) - size / NEAR_ZERO,
    )
    noise = first.fits[0]["alpha"].noise if "alpha" in first.fits[0] else 0.0
    for constant, stiffness in (("Z_0", "Z_alpha"), ("M_0", "M_alpha")):
        k = PARAMETERS.index(constant)
        tolerance[k] = np.fmax(tolerance[k], size[PARAMETERS.index(stiffness)] * noise)
    tolerance = np.fmax(tolerance, LEAST)
    for name, value in plan.tolerance.items():
        tolerance[PARAMETERS.index(name)] = value
    return tolerance


def unnoticeable_change(estimate: Estimate) -> FloatArray:
    """The change of each parameter alone that moves the response by as much as the noise, δ.

    A diagonal element of the information matrix is the summed square of the response's change per unit
    of the parameter, in standard deviations of the noise; over N samples its mean square is one where
    the parameter moves by √(N / information).

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit; infinite where the response does not depend on it.
    """
    samples = sum(len(fit.t) for fits in estimate.fits for fit in fits.values())
    information = np.diag(information_of(estimate.covariance_cr))
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(samples / information))
