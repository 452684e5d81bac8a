"""The rule ``information``: narrow enough, and able to predict the next manoeuvre.

The paper's criterion asks whether the last estimates scatter little beside their mean. That has no
scale where a parameter is near zero, and it forgets every manoeuvre outside its window. This rule asks
what the crew wants to know: is the 95 % interval of every parameter, from all usable manoeuvres
together, narrower than the tolerance, and did the estimate predict the newest manoeuvre before it had
used it?
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from advisor.aircraft import PARAMETERS, CampaignPlan
from advisor.decision.pooling import (
    Belief,
    beliefs_at_one_speed,
    disagreement,
    inconsistency,
    information_of,
    pool,
)
from advisor.flight.messages import FloatArray
from advisor.oem.estimate import Estimate

Z95 = 1.959963984540054
"""Half-width of a 95 % interval in standard deviations."""

NOISE_SHARE = 0.5
"""A change of a parameter that moves the response by less than this share of the noise is no change."""

PREDICTION_LEVEL = 0.99
CONSISTENCY_LEVEL = 0.95


@dataclass(frozen=True, slots=True)
class Knowledge:
    """How well the aircraft is known after some manoeuvres."""

    belief: Belief
    """From all usable manoeuvres; widened when they scatter more than their intervals say."""
    tolerance: FloatArray
    """Shape (8,). What each 95 % half-width must stay below."""
    predicted: bool
    """Whether the manoeuvres before the newest predicted it; False while there is only one."""
    surprise: float
    """Distance of the newest from its prediction, as a share of the 99 % limit; NaN without one."""

    @property
    def share(self) -> FloatArray:
        """Shape (8,). Half-width of each 95 % interval as a share of its tolerance; infinite when unknown."""
        known = np.isfinite(self.belief.std) & np.isfinite(self.belief.theta)
        return np.where(known, Z95 * np.where(known, self.belief.std, 0.0) / self.tolerance, np.inf)

    @property
    def percent(self) -> float:
        """The criterion: the largest `share`, in percent; stop below 100."""
        return 100.0 * float(np.max(self.share))

    @property
    def holding_back(self) -> str:
        """The parameter with the largest `share`."""
        return PARAMETERS[int(np.argmax(self.share))]

    @property
    def sufficient(self) -> bool:
        """Whether this rule says stop."""
        return self.predicted and self.percent < 100.0


def knowledge(estimates: Sequence[Estimate], plan: CampaignPlan) -> Knowledge:
    """What is known after the usable manoeuvres ``estimates`` (at least one), in the order flown."""
    beliefs = beliefs_at_one_speed(estimates)
    pooled = widened(beliefs)
    predicted, surprise = False, float("nan")
    if len(beliefs) > 1:
        before = widened(beliefs[:-1])
        distance, dof = disagreement(before, _scaled(beliefs[-1], _excess(beliefs[:-1])))
        surprise = distance / float(chi2.ppf(PREDICTION_LEVEL, dof)) if dof else float("nan")
        predicted = surprise < 1.0
    return Knowledge(pooled, tolerances(pooled.theta, estimates, plan), predicted, surprise)


def tolerances(theta: FloatArray, estimates: Sequence[Estimate], plan: CampaignPlan) -> FloatArray:
    """The half-width each parameter's 95 % interval must stay below.

    The share ``plan.tolerance_percent`` of the parameter; for one near zero, where such a share is
    smaller than anything that matters, the change that moves the response by `NOISE_SHARE` of the
    noise; or what ``plan.tolerance`` says of it.

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit.
    """
    tolerance = np.fmax(
        0.01 * plan.tolerance_percent * np.abs(theta), NOISE_SHARE * unnoticeable_change(estimates)
    )
    for name, value in plan.tolerance.items():
        tolerance[PARAMETERS.index(name)] = value
    return tolerance


def unnoticeable_change(estimates: Sequence[Estimate]) -> FloatArray:
    """The change of each parameter alone that moves the response by as much as the noise.

    A diagonal element of the information matrix is the summed square of the response's change per unit
    of the parameter, in standard deviations of the noise; over N samples its mean square is one where
    the parameter moves by √(N / information).

    Returns
    -------
    FloatArray
        Shape (8,), each in its parameter's unit; infinite where the response does not depend on it.
    """
    samples = sum(len(fit.t) for e in estimates for fits in e.fits for fit in fits.values())
    information = sum(
        (np.diag(information_of(e.covariance_cr)) for e in estimates), np.zeros(len(PARAMETERS))
    )
    with np.errstate(divide="ignore"):
        return np.asarray(np.sqrt(samples / information))


def widened(beliefs: Sequence[Belief]) -> Belief:
    """Pooled belief, wider where the manoeuvres contradict each other more than their errors allow."""
    return _scaled(pool(beliefs), _excess(beliefs))


def _scaled(belief: Belief, factor: float) -> Belief:
    return Belief(belief.theta, factor * belief.covariance)


def _excess(beliefs: Sequence[Belief]) -> float:
    """Variance ratio of the scatter between manoeuvres to their stated errors, 1 unless significant.

    The Birge ratio of metrology: χ² of the derivatives about their pooled value over its degrees of
    freedom.
    """
    if len(beliefs) < 2:
        return 1.0
    total, dof = inconsistency(beliefs)
    return 1.0 if dof < 1 or total < float(chi2.ppf(CONSISTENCY_LEVEL, dof)) else total / dof
