"""Warnings about the criterion: it no longer holds, cannot fall, or excludes manoeuvres."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.change import Change
from advisor.decision.course import CriterionCourse
from advisor.decision.history import CandidateManeuver, usable_ones
from advisor.decision.judge import accepted_estimates, results_of
from advisor.decision.larger import larger_and_agreeing
from advisor.decision.paper_rules import SCATTER_FACTOR, window
from advisor.decision.verdict import RuleProgress
from advisor.oem.estimate import Estimate
from advisor.words.quantiles import NORMAL_95
from advisor.words.quantities import symbol


def warnings(
    history: Sequence[CandidateManeuver], chosen: RuleProgress, change: Change | None, course: CriterionCourse
) -> tuple[str, ...]:
    """Return sentences about facts that the criterion alone does not show."""
    plan, found = course.plan, []
    if chosen.stopped_at is not None and not chosen.holds:
        found.append(
            f"The criterion held after manoeuvre {chosen.stopped_at} and does not hold any more: "
            "later manoeuvres contradict the earlier ones."
        )
    if change is not None:
        found.append(change.sentence)
    if plan.rule == "information":
        found += _left_out(history, course)
    elif not chosen.holds:
        found += _cannot_fall(accepted_estimates(history, plan.rule), plan)
        found += _locked_out(history, course)
    return tuple(found)


def _left_out(history: Sequence[CandidateManeuver], course: CriterionCourse) -> list[str]:
    numbers = [i for i, flown in enumerate(history, start=1) if flown.usable]
    if not numbers:
        return []
    names = [str(numbers[k]) for k in course.knowledge(usable_ones(history)).left_out]
    return [f"Manoeuvre {', '.join(names)} contradicts all the others and is left out."] if names else []


def _cannot_fall(accepted: Sequence[Estimate], plan: CampaignPlan) -> list[str]:
    """Return a warning if one manoeuvre's error alone makes the estimates scatter beyond the limit."""
    theta = window(accepted, plan)
    if theta is None or plan.criterion != "eq12":
        return []
    error = np.sqrt(np.mean([np.diag(e.covariance) for e in accepted[-plan.window :]], axis=0))
    value = np.abs(theta.mean(axis=0))
    blocking = [
        f"{symbol(name)} ({v:.2g} ± {NORMAL_95 * std:.2g})"
        for name, v, std in zip(PARAMETERS, value, error, strict=True)
        if 100.0 * SCATTER_FACTOR * std > plan.limit_percent * v
    ]
    if not blocking:
        return []
    return [
        f"This criterion will hardly fall below {plan.limit_percent:.0f} %: one manoeuvre's error is too "
        f"large relative to {', '.join(blocking)}. The rule information weighs all manoeuvres together."
    ]


def _locked_out(history: Sequence[CandidateManeuver], course: CriterionCourse) -> list[str]:
    """Return a warning if several usable manoeuvres in a row are refused for their cost alone."""
    plan = course.plan
    accepted = [result.accepted for result in results_of(history, plan.rule)]
    refused = 0
    for flown, good in zip(history, accepted, strict=True):
        if flown.usable is not None:
            refused = 0 if good else refused + 1
    if refused and (larger := larger_and_agreeing(history, accepted, course)) and larger.setter:
        return [
            f"Manoeuvre {larger.setter} sets a cost limit that larger ones can hardly meet: the newest moved "
            f"{larger.ratio:.1f} times as much and agrees with it. Exclude manoeuvre {larger.setter}, or use "
            "the rule information."
        ]
    if refused < plan.window:
        return []
    moved = any(flown.air_moved for flown in history[-refused:])
    why = (
        "the air has become rougher" if moved else "the aircraft, its instruments or the flying have changed"
    )
    return [
        f"{refused} usable manoeuvres in a row were refused for their cost alone: {why}. "
        "Exclude the manoeuvre that set the limit, or use the rule information."
    ]
