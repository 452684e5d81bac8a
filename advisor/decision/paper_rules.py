"""The paper's rules: manoeuvre validation, Eqs. (10) and (11), flight-test validation, Eqs. (12) and (13).

The costs are those of usable manoeuvres. A quiet or spoilt record was refused earlier for its own reasons,
and has None in place of a cost. Such a record neither passes a rule nor sets the limit for the next one. The
reading chosen for each equation, and the others tried, are in ``docs/explanation/rules.md``.
"""

from collections.abc import Callable, Mapping, Sequence
from statistics import median

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan, Criterion, Rule
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.pooling import values_at_one_speed
from advisor.decision.verdict import RuleResult
from advisor.flight.signals.messages import FloatArray
from advisor.oem.estimate import Estimate

ALLOWED_INCREASE = 2.0
"""Factor of Eq. (10) by which the cost may rise from one accepted manoeuvre to the next."""
LEAST_COST = 1e-24
"""Least cost det R that is compared, from residuals of 1 µrad and 1 µrad/s. Smaller residuals are below every
instrument's resolution."""

Costs = Sequence[float | None]


def continuous_improvement(costs: Costs) -> tuple[RuleResult, ...]:
    """Apply Eq. (10): J(θ̂ᵢ) < 2·J(θ̂ᵢ₋₁), with i − 1 the last manoeuvre that this rule *accepted*.

    The first usable manoeuvre has no predecessor and is accepted. Costs below `LEAST_COST`, of data without
    noise, count as equal.

    Parameters
    ----------
    costs
        J = det R of every manoeuvre in the order flown; None where it is not usable.
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
    """Apply Eq. (11): J(θ̂ᵢ) < median(J(θ̂₁) … J(θ̂ᵢ₋₁)), over all usable manoeuvres, also the rejected ones.

    The first usable manoeuvre has no predecessor and is accepted.

    Parameters
    ----------
    costs
        As for `continuous_improvement`.
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
    """Accept every usable manoeuvre, whatever its cost: the rule `information` weights manoeuvres instead of
    selecting."""
    return tuple(RuleResult(cost is not None, None) for cost in costs)


MANEUVER_RULES: Mapping[Rule, Callable[[Costs], tuple[RuleResult, ...]]] = {
    "continuous": continuous_improvement,
    "separate": separate_computation,
    "information": every_usable,
}
"""Rule name to its manoeuvre validation. All rules always run side by side."""


SCATTER_FACTOR = 5.0
"""Factor of σ in Eq. (12). The factor belongs to this rule only; a calibrated σ is never multiplied by it."""


def scatter_by_parameter(theta: FloatArray, criterion: Criterion = "eq12") -> FloatArray:
    """Return the scatter of each parameter over a window of estimates, relative to its mean.

    Parameters
    ----------
    theta
        Shape (n, 8). The estimates of the last n accepted manoeuvres, one a row.
    criterion
        ``eq12``: 5·σ/|θ̄| with the sample standard deviation (n − 1 in its denominator).
        ``eq13``: 5·Σ(θ̂ − θ̄)²/(n·|θ̄|), the form that the paper prints. This form is not dimensionless
        and so depends on the units of the parameters (rad and s here).

    Returns
    -------
    FloatArray
        Shape (8,). Infinite where the mean is exactly zero.
    """
    mean = theta.mean(axis=0)
    spread = theta.std(axis=0, ddof=1) if criterion == "eq12" else theta.var(axis=0)
    with np.errstate(divide="ignore", invalid="ignore"):
        relative = SCATTER_FACTOR * spread / np.abs(mean)
    return np.where(spread == 0.0, 0.0, relative)


def scatter_percent(theta: FloatArray, criterion: Criterion = "eq12") -> float:
    """Return the stop criterion: norm over the eight parameters of `scatter_by_parameter`, in percent.

    The norm takes absolute values, so the sign of a parameter's mean does not matter.
    """
    return 100.0 * float(np.linalg.norm(scatter_by_parameter(theta, criterion)))


def scattered_most(theta: FloatArray, criterion: Criterion = "eq12") -> str:
    """Return the parameter that contributes most to `scatter_percent`. One without a value comes first."""
    return PARAMETERS[int(np.argmax(np.nan_to_num(scatter_by_parameter(theta, criterion), nan=np.inf)))]


def window(accepted: Sequence[Estimate], plan: CampaignPlan) -> FloatArray | None:
    """Return the last n accepted estimates at one air speed, shape (n, 8); None for fewer than n."""
    if len(accepted) < plan.window:
        return None
    return values_at_one_speed(accepted[-plan.window :])
