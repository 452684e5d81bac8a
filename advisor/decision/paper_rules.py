"""Rules of the paper: manoeuvre validation, Eqs. (10) and (11), and flight-test validation, Eqs. (12) and
(13).

The costs are those of usable manoeuvres. A quiet or faulty record was refused for other reasons, and has None
as its cost. A record without a cost passes no rule and sets no limit. The interpretation of each equation,
and the alternatives, are in ``docs/explanation/rules.md``.
"""

from collections.abc import Callable, Mapping, Sequence
from statistics import median

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan, Criterion, Rule
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.pooling import values_at_one_speed
from advisor.decision.verdict import RuleResult
from advisor.oem.estimate import Estimate
from advisor.process.arrays import FloatArray

ALLOWED_INCREASE = 2.0
"""Factor of Eq. (10) by which the cost may rise from one accepted manoeuvre to the next."""
LEAST_COST = 1e-24
"""Least cost det R in a comparison, from residuals of 1 µrad and 1 µrad/s. Smaller residuals are below the
resolution of every instrument."""

Costs = Sequence[float | None]


def continuous_improvement(costs: Costs) -> tuple[RuleResult, ...]:
    """Return the results of Eq. (10): J(θ̂ᵢ) < 2·J(θ̂ᵢ₋₁), with i − 1 the last manoeuvre that this rule
    *accepted*.

    The first usable manoeuvre has no predecessor and is accepted. Costs below `LEAST_COST`, from data without
    noise, are treated as equal.

    Parameters
    ----------
    costs
        Cost J = det R of every manoeuvre in the order flown; None for an unusable manoeuvre.
    """
    results = []
    limit: float | None = None
    for cost in costs:
        accepted = cost is not None and (limit is None or cost < limit)
        results.append(RuleResult(accepted, limit))
        if accepted and cost is not None:
            limit = ALLOWED_INCREASE * max(cost, LEAST_COST)
    return tuple(results)


def separate_computation(costs: Costs) -> tuple[RuleResult, ...]:
    """Return the results of Eq. (11): J(θ̂ᵢ) < median(J(θ̂₁) … J(θ̂ᵢ₋₁)), over all usable manoeuvres, even
    rejected ones.

    The first usable manoeuvre has no predecessor and is accepted.

    Parameters
    ----------
    costs
        Costs of the manoeuvres, as for `continuous_improvement`.
    """
    results = []
    earlier: list[float] = []
    for cost in costs:
        limit = median(earlier) if earlier else None
        results.append(RuleResult(cost is not None and (limit is None or cost < limit), limit))
        if cost is not None:
            earlier.append(cost)
    return tuple(results)


def every_usable(costs: Costs) -> tuple[RuleResult, ...]:
    """Return acceptance of every usable manoeuvre: the rule `information` weights manoeuvres instead of
    selecting them."""
    return tuple(RuleResult(cost is not None, None) for cost in costs)


MANEUVER_RULES: Mapping[Rule, Callable[[Costs], tuple[RuleResult, ...]]] = {
    "continuous": continuous_improvement,
    "separate": separate_computation,
    "information": every_usable,
}
"""Manoeuvre validation of each rule, by the rule's name. All rules are always evaluated in parallel."""


SCATTER_FACTOR = 5.0
"""Factor of σ in Eq. (12). The factor belongs to Eq. (12) only, and multiplies no other standard
deviation."""


def scatter_by_parameter(theta: FloatArray, criterion: Criterion = "eq12") -> FloatArray:
    """Return the scatter of each parameter over a window of estimates, relative to its mean.

    Parameters
    ----------
    theta
        Shape (n, 8): estimates of the last n accepted manoeuvres, one per row.
    criterion
        ``eq12``: 5·σ/|θ̄| with the sample standard deviation (n − 1 in its denominator).
        ``eq13``: 5·Σ(θ̂ − θ̄)²/(n·|θ̄|), the form that the paper prints. Eq. (13) is not dimensionless and
        depends on the parameters' units (rad and s here).

    Returns
    -------
    FloatArray
        Shape (8,): relative scatter of each parameter. The scatter is infinite for a mean of exactly zero.
    """
    mean = theta.mean(axis=0)
    spread = theta.std(axis=0, ddof=1) if criterion == "eq12" else theta.var(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = SCATTER_FACTOR * spread / np.abs(mean)
    return np.where(spread == 0.0, 0.0, relative)


def scatter_percent(theta: FloatArray, criterion: Criterion = "eq12") -> float:
    """Return the stop criterion in percent: the norm of `scatter_by_parameter` over the eight parameters.

    The norm takes absolute values, so the sign of a parameter's mean does not matter.
    """
    return 100.0 * float(np.linalg.norm(scatter_by_parameter(theta, criterion)))


def scattered_most(theta: FloatArray, criterion: Criterion = "eq12") -> str:
    """Return the parameter with the largest part in `scatter_percent`. A parameter without a value comes
    first."""
    return PARAMETERS[int(np.argmax(np.nan_to_num(scatter_by_parameter(theta, criterion), nan=np.inf)))]


def window(accepted: Sequence[Estimate], plan: CampaignPlan) -> FloatArray | None:
    """Return the last n accepted estimates at one air speed, shape (n, 8); None for fewer than n."""
    if len(accepted) < plan.window:
        return None
    return values_at_one_speed(accepted[-plan.window :])
