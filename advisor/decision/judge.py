"""Was that manoeuvre good: what speaks against it itself, then the rule the crew chose."""

from collections.abc import Mapping, Sequence

from advisor.aircraft import CampaignPlan, Rule
from advisor.decision.acceptance import MANEUVER_RULES
from advisor.decision.history import Flown
from advisor.decision.verdict import ManeuverVerdict, Reason, RuleResult
from advisor.oem.estimate import Estimate, NoEstimate


def judge_campaign(history: Sequence[Flown], plan: CampaignPlan) -> tuple[ManeuverVerdict, ...]:
    """Verdicts on all manoeuvres flown so far, in the same order, each with what every rule says.

    A verdict depends only on the manoeuvres before it, unless one of them is excluded by hand.
    """
    by_rule = rule_results(history)
    return tuple(
        _verdict(flown, plan.rule, {name: results[i] for name, results in by_rule.items()})
        for i, flown in enumerate(history)
    )


def judge(flown: Flown, history: Sequence[Flown], plan: CampaignPlan) -> ManeuverVerdict:
    """Verdict on the newest manoeuvre, given those before it."""
    return judge_campaign([*history, flown], plan)[-1]


def rule_results(history: Sequence[Flown]) -> Mapping[Rule, tuple[RuleResult, ...]]:
    """What every rule says of every manoeuvre."""
    costs = [estimate.cost if (estimate := flown.usable) else None for flown in history]
    return {name: rule(costs) for name, rule in MANEUVER_RULES.items()}


def accepted_estimates(history: Sequence[Flown], rule: Rule) -> list[Estimate]:
    """Estimates of the manoeuvres that ``rule`` accepts, in the order flown."""
    return [
        estimate
        for flown, result in zip(history, rule_results(history)[rule], strict=True)
        if result.accepted and (estimate := flown.usable)
    ]


def _verdict(flown: Flown, rule: Rule, rules: Mapping[Rule, RuleResult]) -> ManeuverVerdict:
    reasons = _reasons(flown, rule, rules[rule])
    notes = flown.estimate.notes if isinstance(flown.estimate, Estimate) else ()
    cautions = tuple(dict.fromkeys((*flown.cautions, *notes)))
    if flown.excluded_because is not None:
        sentence = f"EXCLUDED by hand: {flown.excluded_because}"
    elif reasons:
        sentence = f"REPEAT: {reasons[0].text}"
    else:
        sentence = f"ACCEPTED: {_why_accepted(flown, rule, rules[rule])}"
    return ManeuverVerdict(
        not reasons, sentence, reasons, {str(name): result for name, result in rules.items()}, cautions
    )


def _reasons(flown: Flown, rule: Rule, result: RuleResult) -> tuple[Reason, ...]:
    if flown.excluded_because is not None:
        text = f"excluded by hand: {flown.excluded_because}"
        return (Reason("excluded", text, 1.0, 0.0), *flown.reasons)
    if isinstance(flown.estimate, NoEstimate):
        return (*flown.reasons, Reason(flown.estimate.code, flown.estimate.text, 0.0, 1.0))
    if flown.reasons or result.accepted or result.limit is None:
        return flown.reasons
    cost, limit = flown.estimate.cost, result.limit
    return (Reason("cost", _TOO_COSTLY[rule].format(cost=cost, limit=limit), cost, limit),)


def _why_accepted(flown: Flown, rule: Rule, result: RuleResult) -> str:
    if rule == "information":
        return "good manoeuvre, it adds to what is known"
    if result.limit is None or isinstance(flown.estimate, NoEstimate):
        return "good manoeuvre, the first to compare others with"
    return f"cost {flown.estimate.cost:.2g}, limit {result.limit:.2g}"


_TOO_COSTLY: Mapping[Rule, str] = {
    "continuous": (
        "the model explains it less well than the last accepted one, cost {cost:.2g} (limit {limit:.2g}); "
        "fly it again in calmer air"
    ),
    "separate": (
        "the model explains it no better than half of the earlier ones, cost {cost:.2g} "
        "(limit {limit:.2g}); fly it again"
    ),
}
