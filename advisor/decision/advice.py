"""Advice on the next manoeuvre: the best input, the number of further manoeuvres, and the parameter that
delays the stop."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.conditions import (
    Conditions,
    by_information,
    by_scatter,
    errors_as_flown,
    find_conditions,
    odds_of,
    share_after,
    travel_of,
)
from advisor.decision.first_unit import first_unit_s
from advisor.decision.history import CandidateManeuver, is_named, usable_ones
from advisor.decision.information import CriterionCourse, Knowledge
from advisor.decision.inputs import ORDERS, StepInput, units_to_try
from advisor.decision.judge import accepted_estimates
from advisor.decision.paper_rules import scattered_most, window
from advisor.decision.prediction import expect
from advisor.decision.verdict import NO_CURE_BY_INPUT, NextInput, Remaining
from advisor.model.short_period import ShortPeriod
from advisor.process.arrays import FloatArray

GENTLE = 0.1
"""Amplitude of the first input, as a share of the elevator's travel. Before the first manoeuvre no property
of the aircraft is known. Larger inputs follow in steps (``conditions.BOLDER``)."""
Choice = tuple[StepInput, FloatArray]
"""A test input, and the covariance (8, 8) of the errors that it is expected to give."""
PASSING = {"separate": 0.5}
"""Share of equally good manoeuvres that the rule accepts. Eq. (11) rejects half of them, and Eq. (10) hardly
any."""


def next_input(
    history: Sequence[CandidateManeuver], aircraft: Aircraft, course: CriterionCourse | None = None
) -> NextInput:
    """Return the next input after the last manoeuvre of ``history``. ``course`` is the cache of
    ``flight_test``.

    The number of further manoeuvres is predicted after the first usable manoeuvre.
    """
    plan = aircraft.campaign
    course = course or CriterionCourse(plan)
    conditions = find_conditions(history, aircraft, course)
    mend = _mend(history[-1]) if history else ""
    if conditions is None and not mend and not (history and is_named(history[-1])):
        return _first_input(aircraft, history)
    if conditions is None:
        return NextInput(f"next: {mend or _same_but_better(history[-1])}", None)
    knowledge = course.knowledge(usable_ones(history))
    choice = None if mend else _choose(conditions, knowledge, plan)
    chosen = choice[0] if choice else None
    spoken = chosen.spoken(conditions.travel_rad) if chosen else mend or "the elevator's last input again"
    remaining, held_by = forecast(history, course), _held_by(history, plan, knowledge)
    return NextInput(f"next: {spoken}", remaining, held_by, chosen)


def _choose(conditions: Conditions, knowledge: Knowledge, plan: CampaignPlan) -> Choice | None:
    std = np.sqrt(knowledge.widening * np.diag(conditions.last_covariance))
    return best_input(conditions, std, lambda expected: _distance_to_stop(expected, plan, knowledge))


def _distance_to_stop(covariance: FloatArray, plan: CampaignPlan, knowledge: Knowledge) -> float:
    """Return the distance to the stop after one more manoeuvre with these errors; smaller is better."""
    if plan.rule == "information":
        return share_after(knowledge, covariance, 1)
    std = np.sqrt(np.diag(covariance))
    size = np.maximum(np.abs(knowledge.posterior.theta), knowledge.posterior.std)
    return float(np.linalg.norm(std / size))


def forecast(history: Sequence[CandidateManeuver], course: CriterionCourse) -> Remaining:
    """Return the expected number of further manoeuvres if the crew continues as it has flown. At least one
    manoeuvre of ``history`` is usable."""
    plan, usable = course.plan, usable_ones(history)
    knowledge = course.knowledge(usable)
    odds = odds_of(history, course)
    as_flown = errors_as_flown(usable, knowledge.widening)
    if plan.rule == "information":
        return by_information(knowledge, as_flown, odds)
    members = np.array([e.theta for e in accepted_estimates(history, plan.rule, plan)]).reshape(
        -1, len(PARAMETERS)
    )
    passing = odds.usable.mean * PASSING.get(plan.rule, 1.0)
    return by_scatter(members, knowledge.posterior, np.sqrt(np.diag(as_flown)), plan, passing)


def _held_by(history: Sequence[CandidateManeuver], plan: CampaignPlan, knowledge: Knowledge) -> str:
    if plan.rule != "information":
        members = window(accepted_estimates(history, plan.rule, plan), plan)
        if members is not None:
            return scattered_most(members, plan.criterion)
    return knowledge.holding_back


def _first_input(aircraft: Aircraft, history: Sequence[CandidateManeuver]) -> NextInput:
    """Return the first input's advice: a small 3-2-1-1, timed by the file's model or by the log."""
    unit = first_unit_s("elevator", aircraft, others=[flown.estimate for flown in history])
    travel = travel_of(aircraft.elevator.ends_deg)
    gentle = StepInput("3-2-1-1", unit, GENTLE * travel, nose_up_first=True)
    return NextInput(f"next: {gentle.spoken(travel)}, to begin gently", None, None, gentle)


def _same_but_better(flown: CandidateManeuver) -> str:
    """Return the advice to repeat the input with the remedy of the newest first reason."""
    remedy = _remedy(flown)
    kind = flown.maneuver.span.kind if flown.maneuver is not None and is_named(flown) else "last input"
    return f"the elevator's {kind} again{f', {remedy}' if remedy else ''}"


def _mend(flown: CandidateManeuver) -> str:
    """Return the remedy for a faulty channel, which precedes any other input; else empty."""
    if flown.reasons and (flown.reasons[0].by_instrument or flown.reasons[0].code in NO_CURE_BY_INPUT):
        return _remedy(flown)
    wrong = flown.maneuver.distrusts if flown.maneuver else ()
    return wrong[0].fix if wrong else ""


def _remedy(flown: CandidateManeuver) -> str:
    """Return the remedy that the first reason names; empty without a reason."""
    return flown.reasons[0].remedy if flown.reasons else ""


def best_input(
    conditions: Conditions, measured_std: FloatArray, distance_to_stop: Callable[[FloatArray], float]
) -> Choice | None:
    """Return the input after which the distance to the stop is expected to be least; None without a
    prediction.

    Parameters
    ----------
    measured_std
        Shape (8,): standard deviations of the last manoeuvre's estimate. The causes of these errors, such as
        coloured residuals, persist in the next manoeuvre. The prediction gives the ratio between the inputs'
        errors.
    distance_to_stop
        Function from the covariance of the next manoeuvre's errors to a distance from the stop.
    """
    repeated = expect(conditions.theta, conditions.flown, conditions.instruments)
    if repeated is None:
        return None
    ratio = measured_std / repeated.std
    scale = np.outer(ratio, ratio)
    expected = [(option, covariance * scale) for option, covariance in _options(conditions)]
    return min(expected, key=lambda choice: distance_to_stop(choice[1])) if expected else None


def _options(conditions: Conditions) -> Iterator[Choice]:
    """Yield inputs in the direction opposite to the last manoeuvre's, with their expected errors."""
    frequency = ShortPeriod(conditions.theta).natural_frequency
    if not np.isfinite(frequency) or frequency <= 0.0:
        return
    for order in ORDERS:
        for unit in units_to_try(frequency):
            option = StepInput(order, float(unit), conditions.largest_rad, not conditions.nose_up_first)
            choice = _as_large_as_allowed(option, conditions)
            if choice is not None:
                yield choice


def _as_large_as_allowed(option: StepInput, conditions: Conditions) -> Choice | None:
    """Return the input scaled up to the limit of α, which is exact in a linear model."""
    length = conditions.lead_s + option.duration_s + conditions.free_s
    elevator = option.elevator(conditions.trim_rad, conditions.lead_s, length)
    full = expect(conditions.theta, elevator, conditions.instruments)
    if full is None or not full.alpha_excursion > 0.0:
        return None
    amplitude = min(1.0, conditions.alpha_rad / full.alpha_excursion) * option.amplitude_rad
    allowed = StepInput(option.order, option.unit_s, amplitude, option.nose_up_first).rounded(
        conditions.travel_rad
    )
    return allowed, full.covariance * (option.amplitude_rad / allowed.amplitude_rad) ** 2
