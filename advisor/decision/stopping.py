"""Flight-test validation under every rule, and the verdict of the chosen rule."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Rule
from advisor.decision.acceptance import MANEUVER_RULES
from advisor.decision.advice import next_input
from advisor.decision.course import CriterionCourse
from advisor.decision.evidence import evidence, sentence
from advisor.decision.history import CandidateManeuver, estimates_of, nothing_tested, usable_ones
from advisor.decision.information import Knowledge
from advisor.decision.judge import accepted_estimates, results_of
from advisor.decision.scatter import scatter_percent, scattered_most, window
from advisor.decision.verdict import FlightTestVerdict, RuleProgress, limit_percent
from advisor.decision.warnings import warnings
from advisor.oem.estimate import Estimate
from advisor.words.digits import distinct_texts
from advisor.words.quantities import symbol

_NO_SCALE_PERCENT = 1000.0


def flight_test(
    history: Sequence[CandidateManeuver],
    plan: CampaignPlan,
    aircraft: Aircraft | None = None,
    course: CriterionCourse | None = None,
) -> FlightTestVerdict:
    """Return whether testing may stop, and the next input, after the last manoeuvre of ``history``.

    The decision says whether the chosen rule's criterion holds *now*; ``stopped_at`` keeps when it first
    held. The two differ when a later manoeuvre contradicts the earlier ones. ``aircraft`` gives the limits of
    the next input. A ``course`` keeps results of earlier decisions, and changes no verdict.
    """
    course = course or CriterionCourse(plan)
    by_rule: dict[str, RuleProgress] = {
        rule: progress(history, rule, plan, course) for rule in MANEUVER_RULES
    }
    chosen = by_rule[plan.rule]
    criterion = chosen.history_percent[-1] if chosen.history_percent else None
    usable = usable_ones(history)
    known = course.known(usable) if usable else None
    stop = _holds_now(known, plan, criterion)
    said = nothing_tested(history)
    if known is not None:
        by_information = plan.rule == "information"
        said = sentence(known, stop) if by_information else _scatter_sentence(history, plan, criterion, stop)
    return FlightTestVerdict(
        rule=plan.rule,
        decision="stop" if stop else "continue",
        sentence=said,
        criterion_percent=criterion,
        limit_percent=chosen.limit_percent,
        stopped_at=chosen.stopped_at,
        by_rule=by_rule,
        next=next_input(history, replace(aircraft or Aircraft(), campaign=plan), stop, course),
        warnings=warnings(history, chosen, stop, course),
        evidence=evidence(known) if known else (),
    )


def progress(
    history: Sequence[CandidateManeuver],
    rule: Rule,
    plan: CampaignPlan,
    course: CriterionCourse | None = None,
) -> RuleProgress:
    """Return the stop criterion of one rule after each manoeuvre. ``course`` is explained in
    ``flight_test``."""
    course = course or CriterionCourse(plan)
    limit = limit_percent(rule, plan)
    values: list[float | None] = []
    stopped_at = None
    taken: list[CandidateManeuver] = []
    value, sufficient = None, False
    for number, (flown, ok) in enumerate(zip(history, _weighed(history, rule), strict=True), start=1):
        if ok:
            taken.append(flown)
            if rule == "information":
                standing = course.standing(taken)
                value, sufficient = _finite(standing.percent), standing.sufficient
            else:
                value = _scatter(estimates_of(taken[-plan.window :]), plan)
                sufficient = value is not None and value < limit
        values.append(value)
        if sufficient and stopped_at is None:
            stopped_at = number
    if rule != "information" or not taken:
        return RuleProgress(stopped_at, tuple(values), limit)
    known = course.known(taken)
    shares = {name: _finite(100.0 * share) for name, share in known.share.items()}
    return RuleProgress(
        stopped_at,
        tuple(values),
        limit,
        {name: _finite(band) for name, band in known.prediction_percent.items()},
        {name: shares[name] for name in known.named},
    )


def _weighed(history: Sequence[CandidateManeuver], rule: Rule) -> list[bool]:
    """Return which manoeuvres enter a rule's criterion.

    The rule ``information`` uses all usable ones, because it detects contradictions itself.
    """
    if rule == "information":
        return [flown.usable is not None for flown in history]
    return [result.accepted for result in results_of(history, rule)]


def _scatter(accepted: Sequence[Estimate], plan: CampaignPlan) -> float | None:
    theta = window(accepted, plan)
    return None if theta is None else _finite(scatter_percent(theta, plan.criterion))


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _holds_now(known: Knowledge | None, plan: CampaignPlan, criterion: float | None) -> bool:
    if plan.rule == "information":
        return known is not None and known.sufficient
    return criterion is not None and criterion < plan.limit_percent


def _scatter_sentence(
    history: Sequence[CandidateManeuver], plan: CampaignPlan, criterion: float | None, stop: bool
) -> str:
    accepted = accepted_estimates(history, plan.rule)
    if criterion is None:
        return f"CONTINUE: {len(accepted)} of {plan.window} accepted manoeuvres."
    verb = "TEST COMPLETE" if stop else "CONTINUE"
    held = "" if stop else f"; {_scattered_most(accepted, plan)} scatters most"
    # For a parameter near zero the relative scatter has no scale; its digits would pretend one.
    scatter, limit = distinct_texts(criterion, plan.limit_percent)
    agreement = f"agree within {scatter} %" if criterion < _NO_SCALE_PERCENT else "do not agree"
    return f"{verb}: the last {plan.window} accepted manoeuvres {agreement} (limit {limit} %){held}."


def _scattered_most(accepted: Sequence[Estimate], plan: CampaignPlan) -> str:
    theta = window(accepted, plan)
    assert theta is not None
    return symbol(scattered_most(theta, plan.criterion))
