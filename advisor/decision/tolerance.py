"""How well a parameter must be known: the crew's percentage, and what stands in for it near zero."""

from collections.abc import Mapping

import numpy as np

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.pooling import information_of
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate

NEAR_ZERO = 3.0
"""A parameter is near zero when its whole effect on the response is less than this many times the noise."""

DERIVATIVE_SHARE = 2.0
"""A derivative's own tolerance as a multiple of the prediction's.

The short period's frequency goes with the root of the stiffness: a derivative that is wrong by 10 % moves
the frequency by about 5 %. M_delta_e scales the whole response, so that the band of the prediction holds
M_delta_e closer.
"""

LEAST = 1e-12
"""No tolerance is smaller, in any unit: data without noise leave nothing to be tolerant of."""


def tolerances(theta: FloatArray, first: Estimate, plan: CampaignPlan) -> FloatArray:
    """The half-width each parameter's 95 % interval must stay below.

    ``DERIVATIVE_SHARE`` times ``plan.tolerance_percent`` of the parameter, or what moves the frequency or
    the damping of the short period by ``plan.tolerance_percent``, whichever is larger. For a parameter near
    zero, a share of which is smaller than anything that matters: with δ the change that moves the response
    by as much as the noise, δ itself at zero, falling to nothing extra at 3·δ. Z_0 and M_0, which hold the
    trim, may also be wrong by what shifts the trim by as much as the noise of a measured angle of attack.
    What ``plan.tolerance`` says of a parameter stands above all this.

    Noise and response are those of the ``first`` usable manoeuvre: a bolder one shows more, and must
    not move the goal while it is being approached.

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit.
    """
    size = np.abs(theta)
    tolerance = np.fmax(
        0.01 * DERIVATIVE_SHARE * plan.tolerance_percent * size,
        unnoticeable_change(first) - size / NEAR_ZERO,
    )
    for name, change in _moving_the_short_period(theta).items():
        k = PARAMETERS.index(name)
        tolerance[k] = np.fmax(tolerance[k], 0.01 * plan.tolerance_percent * change)
    noise = first.fits[0]["alpha"].noise if "alpha" in first.fits[0] else 0.0
    for constant, stiffness in (("Z_0", "Z_alpha"), ("M_0", "M_alpha")):
        k = PARAMETERS.index(constant)
        tolerance[k] = np.fmax(tolerance[k], size[PARAMETERS.index(stiffness)] * noise)
    tolerance = np.fmax(tolerance, LEAST)
    for name, value in plan.tolerance.items():
        tolerance[PARAMETERS.index(name)] = value
    return tolerance


def _moving_the_short_period(theta: FloatArray) -> Mapping[str, float]:
    """Change of a derivative, per relative change of the frequency or of the damping that the change makes.

    ω² = Z_α·M_q - (1 + Z_q)·M_α and 2·ζ·ω = -(Z_α + M_q): where M_q is a small part of the damping, much of
    M_q makes little difference."""
    z_alpha, z_q, m_alpha, m_q = (theta[PARAMETERS.index(n)] for n in ("Z_alpha", "Z_q", "M_alpha", "M_q"))
    damping = abs(z_alpha + m_q)
    stiffness = abs(z_alpha * m_q - (1.0 + z_q) * m_alpha)
    return {"Z_alpha": damping, "M_q": damping, "M_alpha": 2.0 * stiffness}


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
