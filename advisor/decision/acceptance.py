"""Manoeuvre validation: which costs are good enough, Eqs. (10) and (11) of the paper.

The costs handed in are those of usable manoeuvres: a quiet or spoilt record was refused for its own
reasons before it came here, so it neither passes a rule nor sets the limit for the next one. None
stands for such a manoeuvre. The readings chosen, and those tried, are in ``docs/explanation/rules.md``.
"""

from collections.abc import Callable, Mapping, Sequence
from statistics import median

from advisor.aircraft import Rule
from advisor.decision.verdict import RuleResult

ALLOWED_INCREASE = 2.0
"""The factor of Eq. (10)."""
LEAST_COST = 1e-24
"""det R of residuals of 1 µrad and 1 µrad/s: below every instrument's resolution a cost says nothing."""

Costs = Sequence[float | None]


def continuous_improvement(costs: Costs) -> tuple[RuleResult, ...]:
    """Eq. (10): J(θ̂ᵢ) < 2·J(θ̂ᵢ₋₁), with i − 1 the last manoeuvre this rule *accepted*.

    The first usable manoeuvre has nothing to be compared with and is accepted. Costs below
    `LEAST_COST`, of data without noise, count as equal.

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
    """Eq. (11): J(θ̂ᵢ) < median(J(θ̂₁) … J(θ̂ᵢ₋₁)), over all usable manoeuvres, also those it rejected.

    The first usable manoeuvre has nothing to be compared with and is accepted.

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
    """Every usable manoeuvre, whatever its cost: the rule `information` weighs instead of choosing."""
    return tuple(RuleResult(cost is not None, None) for cost in costs)


MANEUVER_RULES: Mapping[Rule, Callable[[Costs], tuple[RuleResult, ...]]] = {
    "continuous": continuous_improvement,
    "separate": separate_computation,
    "information": every_usable,
}
"""Manoeuvre validation by the name of the rule; all of them always run side by side."""
