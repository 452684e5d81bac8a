"""Verdict on a manoeuvre: objections to its data, then the rule that the crew chose."""

from collections.abc import Container, Mapping, Sequence
from math import degrees, floor

from advisor.aircraft.aircraft import CampaignPlan, Rule
from advisor.decision.history import CandidateManeuver, has_begun
from advisor.decision.information import USUAL, Outlier, outliers
from advisor.decision.paper_rules import MANEUVER_RULES
from advisor.decision.pooling import posteriors_at_one_speed
from advisor.decision.verdict import NO_TEST, ManeuverVerdict, Reason, RuleResult, with_one_remedy
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.words.quantities import distinct_texts

COLOURED = 0.5
"""Lag-1 correlation of a residual above which moving air or a model error is assumed."""


def judge_campaign(history: Sequence[CandidateManeuver], plan: CampaignPlan) -> tuple[ManeuverVerdict, ...]:
    """Return verdicts on all manoeuvres so far, in the order flown, each with the result of every rule.

    A verdict depends only on the earlier manoeuvres, except for two later influences. A manoeuvre may be
    excluded by hand. Under the rule ``information`` later manoeuvres may show that a manoeuvre contradicts
    all others.
    """
    contradicted = contradicting(history, plan)
    by_rule = {rule: _results(history, rule, contradicted) for rule in MANEUVER_RULES}
    verdicts = []
    for i, flown in enumerate(history):
        rules = {name: results[i] for name, results in by_rule.items()}
        begun = has_begun(history[: i + 1])
        verdicts.append(_verdict(flown, plan.rule, rules, contradicted.get(i), begun))
    return tuple(verdicts)


def results_of(
    history: Sequence[CandidateManeuver], rule: Rule, plan: CampaignPlan = USUAL
) -> tuple[RuleResult, ...]:
    """Return the result of one rule for every manoeuvre."""
    return _results(history, rule, contradicting(history, plan) if rule == "information" else ())


def _results(
    history: Sequence[CandidateManeuver], rule: Rule, outliers: Container[int]
) -> tuple[RuleResult, ...]:
    costs = [estimate.cost if (estimate := flown.usable) else None for flown in history]
    results = MANEUVER_RULES[rule](costs)
    if rule != "information":
        return results
    return tuple(RuleResult(r.accepted and i not in outliers, r.limit) for i, r in enumerate(results))


def contradicting(history: Sequence[CandidateManeuver], plan: CampaignPlan) -> Mapping[int, Outlier]:
    """Return the usable manoeuvres that contradict all others, by index. The rule ``information`` excludes
    these manoeuvres."""
    usable = [(i, estimate) for i, flown in enumerate(history) if (estimate := flown.usable)]
    odd = outliers(posteriors_at_one_speed([estimate for _, estimate in usable]), plan)
    return {usable[k][0]: outlier for k, outlier in odd.items()}


def accepted_estimates(
    history: Sequence[CandidateManeuver], rule: Rule, plan: CampaignPlan = USUAL
) -> list[Estimate]:
    """Return the estimates of the manoeuvres that a rule accepts, in the order flown."""
    return [
        estimate
        for flown, result in zip(history, results_of(history, rule, plan), strict=True)
        if result.accepted and (estimate := flown.usable)
    ]


def _verdict(
    flown: CandidateManeuver,
    rule: Rule,
    rules: Mapping[Rule, RuleResult],
    outlier: Outlier | None,
    begun: bool,
) -> ManeuverVerdict:
    reasons = with_one_remedy(_reasons(flown, rule, rules[rule], outlier))
    notes = flown.estimate.notes if isinstance(flown.estimate, Estimate) else ()
    cautions = tuple(dict.fromkeys((*flown.cautions, *notes)))
    if flown.excluded_because is not None:
        sentence = f"EXCLUDED by hand: {flown.excluded_because}"
    elif reasons:
        rejected = "REPEAT" if begun else NO_TEST
        sentence = f"{'UNUSABLE' if reasons[0].by_instrument else rejected}: {reasons[0].text}"
    else:
        sentence = f"ACCEPTED: {_why_accepted(flown, rule, rules[rule])}"
    return ManeuverVerdict(
        not reasons, sentence, reasons, {str(name): result for name, result in rules.items()}, cautions
    )


def _reasons(
    flown: CandidateManeuver, rule: Rule, result: RuleResult, outlier: Outlier | None
) -> tuple[Reason, ...]:
    if flown.excluded_because is not None:
        text = f"excluded by hand: {flown.excluded_because}"
        return (Reason("excluded", text, 1.0, 0.0), *flown.reasons)
    if isinstance(flown.estimate, NoEstimate):
        return (*flown.reasons, Reason(flown.estimate.code, flown.estimate.text, 0.0, 1.0))
    if flown.reasons or result.accepted:
        return flown.reasons
    if rule == "information":
        return (_contradicts(outlier),) if outlier else ()
    return (_too_costly(flown, flown.estimate, rule, result.limit or 0.0),)


def _why_accepted(flown: CandidateManeuver, rule: Rule, result: RuleResult) -> str:
    if isinstance(flown.estimate, NoEstimate):
        return "good manoeuvre"
    if rule == "information":
        compared = "it adds information"
    elif result.limit is None:
        compared = "the first one, with which others are compared"
    else:
        compared = _of_limit(flown.estimate.cost, result.limit)
    return f"good manoeuvre, {_explained(flown.estimate, flown.responses)}{compared}"


def _explained(estimate: Estimate, responses: Sequence[str]) -> str:
    """Return a clause about the share of the motion that the model explains; empty without a fit."""
    fits = estimate.fits[0] if estimate.fits else {}
    share = min((fit.r2 for name, fit in fits.items() if name in responses), default=0.0)
    # Cut, not rounded: 100 % is printed for an exact fit only.
    return f"the model explains {floor(1000.0 * share) / 10.0:.1f} % of it; " if share > 0.0 else ""


def _of_limit(cost: float, limit: float) -> str:
    """Return a cost as a multiple of its limit, because the unit of a cost is not meaningful to a reader."""
    if limit <= 0.0:
        return "cost above its limit, 0"
    ratio = distinct_texts(cost / limit, 1.0, 2)[0]
    return f"cost {ratio} of its limit" if cost < limit else f"cost {ratio} times its limit"


def _contradicts(outlier: Outlier) -> Reason:
    distance, limit = distinct_texts(outlier.sigma, outlier.limit, 1)
    if (apart := outlier.alpha) is not None:
        low, high = (degrees(alpha) for alpha in apart.others_rad)
        where = (
            f"flown about {degrees(apart.middle_rad):.1f} deg of alpha (the others: {low:.1f} to {high:.1f})"
        )
        text = f"{where}, {distance} sigma from them (limit {limit}); fly it at their angle of attack"
        return Reason("alpha_range", text, outlier.sigma, outlier.limit)
    text = f"contradicts all the others, {distance} sigma from them (limit {limit}); fly it again"
    return Reason("odd", text, outlier.sigma, outlier.limit)


def _too_costly(flown: CandidateManeuver, estimate: Estimate, rule: Rule, limit: float) -> Reason:
    than = "no better than half of the earlier ones" if rule == "separate" else _LESS_WELL
    cost = _of_limit(estimate.cost, limit)
    text = f"the model explains it {than}, {cost}; {_another_try(flown, estimate, rule)}"
    return Reason("cost", text, estimate.cost, limit)


_LESS_WELL = "worse than for the last accepted manoeuvre"


def _another_try(flown: CandidateManeuver, estimate: Estimate, rule: Rule) -> str:
    """Return the advice for a repetition of the manoeuvre. Calmer air is advised only if the air moved."""
    if flown.air_moved:
        return "fly it again in calmer air"
    if rule == "separate":
        return "fly it again"
    if any(fit.lag1 > COLOURED for fits in estimate.fits for fit in fits.values()):
        return "fly it again from steady flight, with steps no larger than in that manoeuvre"
    return "fly it again; if the noise stays as large, check the instruments"
