"""Manoeuvre validation: which costs are low enough, Eqs. (10) and (11) of the paper.

The costs are those of usable manoeuvres. A quiet or spoilt record was refused earlier for its own reasons,
and has None in place of a cost. Such a record neither passes a rule nor sets the limit for the next one. The
reading chosen for each equation, and the others tried, are in ``docs/explanation/rules.md``.
"""

from collections.abc import Callable, Mapping, Sequence
from statistics import median

from advisor.aircraft.aircraft import Rule
from advisor.decision.verdict import RuleResult

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
