"""Flight-test validation under every rule, and the verdict of the chosen rule with its conclusion and
warnings.
"""

from collections.abc import Callable, Mapping, Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan, Rule
from advisor.decision.advice import next_input
from advisor.decision.change import Change, find_change
from advisor.decision.history import (
    CandidateManeuver,
    Heard,
    as_heard,
    estimates_of,
    first_stop,
    nothing_tested,
    spoken_after,
    stays,
    usable_ones,
)
from advisor.decision.information import CriterionCourse, evidence, sentence
from advisor.decision.judge import accepted_estimates, results_of
from advisor.decision.paper_rules import MANEUVER_RULES, scatter_percent, scattered_most, window
from advisor.decision.verdict import FlightTestVerdict, NextInput, Remaining, RuleProgress, limit_percent
from advisor.oem.estimate import Estimate
from advisor.words.quantities import distinct_texts, symbol

ENOUGH = NextInput("no further manoeuvre needed", Remaining(0, 0))
"""Advice after a stop that no later data contradict."""


@dataclass(frozen=True, slots=True)
class Criterion:
    """The stop criterion of one axis after its newest manoeuvre."""

    rule: Rule
    by_rule: Mapping[str, RuleProgress]
    """Progress of each rule, by its name, with the history that the crew heard."""
    sentence: Callable[[bool], str]
    """Function that returns the sentence about the criterion, given whether the test stops."""
    next: Callable[[], NextInput]
    """Function that returns the next input if the test continues."""
    flown: int
    """Number of manoeuvres flown."""
    usable: AbstractSet[int]
    """Indices of the usable manoeuvres among the flown ones."""

    @property
    def chosen(self) -> RuleProgress:
        return self.by_rule[self.rule]


def concluded(
    criterion: Criterion,
    heard: Sequence[Heard],
    change: Change | None = None,
    warnings: tuple[str, ...] = (),
    evidence: tuple[str, ...] = (),
) -> FlightTestVerdict:
    """Return the verdict on a flight test.

    A test stops if the criterion of the chosen rule holds now. A stop that the crew has heard remains valid.
    The stop is withdrawn after a change of the aircraft, or if one of its manoeuvres is no longer usable.
    If later data deny the stop, the verdict names the input that closes the criterion again.
    """
    chosen = criterion.chosen
    changed = change.sentence if change is not None and change.confirmed else ""
    stop = chosen.holds or (not changed and stays(heard, criterion.rule, criterion.usable))
    if chosen.holds or chosen.stopped_at is None:
        said = criterion.sentence(stop)
    elif stop:
        said = f"TEST COMPLETE since manoeuvre {chosen.stopped_at}{_since(criterion)}"
    elif changed:
        said = f"CONTINUE: {changed}"
    else:
        said = f"CONTINUE: {_denied(criterion, heard)}; {_open_now(criterion)}"
    is_denied = stop and not chosen.holds and chosen.now_percent is not None
    following = criterion.next() if is_denied or not stop else ENOUGH
    before = heard[criterion.flown - 2] if 1 < criterion.flown <= len(heard) + 1 else None
    return FlightTestVerdict(
        rule=criterion.rule,
        decision="stop" if stop else "continue",
        sentence=said,
        criterion_percent=chosen.now_percent,
        limit_percent=chosen.limit_percent,
        stopped_at=chosen.stopped_at,
        by_rule=criterion.by_rule,
        next=replace(following, remaining=_foretold(stop, before, following.remaining, criterion)),
        warnings=warnings,
        evidence=evidence,
    )


def _open_now(criterion: Criterion) -> str:
    """Return a clause on the part of the criterion that does not hold now."""
    return criterion.sentence(False).removeprefix("CONTINUE: ")


def _since(criterion: Criterion) -> str:
    """Return the end of the sentence about a stop that was heard and whose criterion does not hold now."""
    if criterion.chosen.now_percent is None:
        return ": no change of the aircraft was found since."
    return f"; later data open it again: {_open_now(criterion)}"


def _denied(criterion: Criterion, heard: Sequence[Heard]) -> str:
    """Return a clause about a withdrawn stop, with the reason."""
    stopped_at = criterion.chosen.stopped_at
    if first_stop(heard, criterion.rule) is not None:
        return f"a manoeuvre behind the stop after manoeuvre {stopped_at} does not count any more"
    return f"later manoeuvres contradict the stop after manoeuvre {stopped_at}"


def _foretold(
    stop: bool, before: Heard | None, forecast: Remaining | None, criterion: Criterion
) -> Remaining | None:
    return forecast if stop else spoken_after(before, forecast, criterion.rule, criterion.chosen.now_percent)


def warnings(
    history: Sequence[CandidateManeuver], change: Change | None, course: CriterionCourse
) -> tuple[str, ...]:
    """Return sentences about facts that the criterion alone does not show."""
    plan, sentences = course.plan, []
    if change is not None:
        sentences.append(change.sentence)
    if plan.rule == "information":
        sentences += _left_out(history, course)
    return tuple(sentences)


def _left_out(history: Sequence[CandidateManeuver], course: CriterionCourse) -> list[str]:
    numbers = [i for i, flown in enumerate(history, start=1) if flown.usable]
    if not numbers:
        return []
    names = [str(numbers[k]) for k in course.knowledge(usable_ones(history)).left_out]
    return [f"Manoeuvre {', '.join(names)} contradicts all the others and is left out."] if names else []


_NO_SCALE_PERCENT = 1000.0


def flight_test(
    history: Sequence[CandidateManeuver],
    plan: CampaignPlan,
    aircraft: Aircraft | None = None,
    course: CriterionCourse | None = None,
    heard: Sequence[Heard] = (),
) -> FlightTestVerdict:
    """Return whether testing may stop, and the next input, after the last manoeuvre of ``history``.

    Parameters
    ----------
    course
        Cache of earlier decisions, which changes no verdict.
    """
    course = course or CriterionCourse(plan)
    by_rule: dict[str, RuleProgress] = {
        rule: as_heard(progress(history, rule, plan, course), rule, heard) for rule in MANEUVER_RULES
    }
    chosen = by_rule[plan.rule]
    usable = usable_ones(history)
    so_far = course.knowledge(usable) if usable else None

    def said(stop: bool) -> str:
        if so_far is None:
            return nothing_tested(history)
        if plan.rule == "information":
            return sentence(so_far, stop)
        return _scatter_sentence(history, plan, chosen.now_percent, stop)

    crews = replace(aircraft or Aircraft(), campaign=plan)
    criterion = Criterion(
        plan.rule, by_rule, said, lambda: next_input(history, crews, course), len(history),
        {i for i, flown in enumerate(history) if flown.usable},
    )  # fmt: skip
    change = find_change(history, plan)
    numbers = evidence(so_far) if so_far else ()
    return concluded(criterion, heard, change, warnings(history, change, course), numbers)


def progress(
    history: Sequence[CandidateManeuver],
    rule: Rule,
    plan: CampaignPlan,
    course: CriterionCourse | None = None,
) -> RuleProgress:
    """Return one rule's stop criterion after each manoeuvre. ``course`` is the cache of ``flight_test``."""
    course = course or CriterionCourse(plan)
    limit = limit_percent(rule, plan)
    values: list[float | None] = []
    stopped_at = None
    taken: list[CandidateManeuver] = []
    value, sufficient = None, False
    for number, (flown, ok) in enumerate(zip(history, _weighed(history, rule, plan), strict=True), start=1):
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
    progress_so_far = RuleProgress(
        stopped_at, tuple(values), limit, now_percent=values[-1] if values else None,
        hindsight_percent=tuple(values), hindsight_stopped_at=stopped_at, holds=sufficient,
    )  # fmt: skip
    if rule != "information" or not taken:
        return progress_so_far
    so_far = course.knowledge(taken)
    shares = {name: _finite(100.0 * share) for name, share in so_far.share.items()}
    return replace(
        progress_so_far,
        prediction_percent={name: _finite(band) for name, band in so_far.prediction_percent.items()},
        parameter_percent={name: shares[name] for name in so_far.named},
    )


def _weighed(history: Sequence[CandidateManeuver], rule: Rule, plan: CampaignPlan) -> list[bool]:
    """Return whether each manoeuvre is used in a criterion. The rule ``information`` uses all usable
    manoeuvres.
    """
    if rule == "information":
        return [flown.usable is not None for flown in history]
    return [result.accepted for result in results_of(history, rule, plan)]


def _scatter(accepted: Sequence[Estimate], plan: CampaignPlan) -> float | None:
    theta = window(accepted, plan)
    return None if theta is None else _finite(scatter_percent(theta, plan.criterion))


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _scatter_sentence(
    history: Sequence[CandidateManeuver], plan: CampaignPlan, criterion: float | None, stop: bool
) -> str:
    accepted = accepted_estimates(history, plan.rule, plan)
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
