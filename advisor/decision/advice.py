"""Advice on the next manoeuvre: how many more, which parameter delays the stop, which input helps most."""

from collections.abc import Sequence

import numpy as np

from advisor.aircraft.aircraft import Aircraft, CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.decision.choice import Choice, best_input
from advisor.decision.conditions import Conditions, find_conditions, travel_of
from advisor.decision.course import CriterionCourse
from advisor.decision.history import CandidateManeuver, is_named, usable_ones
from advisor.decision.information import Knowledge
from advisor.decision.inputs import StepInput
from advisor.decision.judge import accepted_estimates
from advisor.decision.remaining import by_information, by_scatter, errors_as_flown, odds_of, share_after
from advisor.decision.scatter import scattered_most, window
from advisor.decision.verdict import NO_CURE_BY_INPUT, NextInput, Remaining
from advisor.flight.signals.messages import FloatArray
from advisor.model.short_period import ShortPeriod

GENTLE = 0.1
"""Amplitude of the first input, as a share of the elevator's travel. Nothing is known of the aircraft yet.
Larger inputs follow step by step (``conditions.BOLDER``)."""
ENOUGH = NextInput("no further manoeuvre needed", Remaining(0, 0))
"""Advice after the stop."""
PASSING = {"separate": 0.5}
"""Share of equally good manoeuvres that pass the rule. Eq. (11) rejects half, Eq. (10) hardly any."""


def next_input(
    history: Sequence[CandidateManeuver],
    aircraft: Aircraft,
    stopped: bool,
    course: CriterionCourse | None = None,
) -> NextInput:
    """Return the input to fly after the last manoeuvre of ``history``. ``course`` is explained in
    ``flight_test``.

    The number of further manoeuvres is foretold once a manoeuvre was usable; before, nothing tells it.
    """
    plan = aircraft.campaign
    if stopped:
        return ENOUGH
    course = course or CriterionCourse(plan)
    conditions = find_conditions(history, aircraft, course)
    mend = _mend(history[-1]) if history else ""
    if conditions is None and not mend and not (history and is_named(history[-1])):
        return _first_input(aircraft)
    if conditions is None:
        return NextInput(f"next: {mend or _same_but_better(history[-1])}", None)
    known = course.known(usable_ones(history))
    choice = None if mend else _choose(conditions, known, plan)
    chosen = choice[0] if choice else None
    spoken = chosen.spoken(conditions.travel_rad) if chosen else mend or "the same again"
    remaining, held_by = forecast(history, course), _held_by(history, plan, known)
    return NextInput(f"next: {spoken}", remaining, held_by, chosen, conditions.travel_rad)


def recommended(history: Sequence[CandidateManeuver], aircraft: Aircraft) -> StepInput | None:
    """Return the input that helps most now; None before the first usable manoeuvre."""
    course = CriterionCourse(aircraft.campaign)
    conditions = find_conditions(history, aircraft, course)
    if conditions is None:
        return None
    known = course.known(usable_ones(history))
    choice = _choose(conditions, known, aircraft.campaign)
    return choice[0] if choice else None


def _choose(conditions: Conditions, known: Knowledge, plan: CampaignPlan) -> Choice | None:
    std = np.sqrt(known.widening * np.diag(conditions.last_covariance))
    return best_input(conditions, std, lambda expected: _distance_to_stop(expected, plan, known))


def _distance_to_stop(covariance: FloatArray, plan: CampaignPlan, known: Knowledge) -> float:
    """Return a measure of the distance to the stop after one more manoeuvre with these errors; smaller is
    better."""
    if plan.rule == "information":
        return share_after(known, covariance, 1)
    std = np.sqrt(np.diag(covariance))
    size = np.maximum(np.abs(known.posterior.theta), known.posterior.std)
    return float(np.linalg.norm(std / size))


def forecast(history: Sequence[CandidateManeuver], course: CriterionCourse) -> Remaining:
    """Return the number of further manoeuvres of a crew that flies on as it has flown, whatever the advice
    is. At least one manoeuvre of ``history`` is usable."""
    plan, usable = course.plan, usable_ones(history)
    known = course.known(usable)
    odds = odds_of(history, course)
    as_flown = errors_as_flown(usable, known.widening)
    if plan.rule == "information":
        return by_information(known, as_flown, odds)
    members = np.array([e.theta for e in accepted_estimates(history, plan.rule)]).reshape(-1, len(PARAMETERS))
    passing = odds.usable.mean * PASSING.get(plan.rule, 1.0)
    return by_scatter(members, known.posterior, np.sqrt(np.diag(as_flown)), plan, passing)


def _held_by(history: Sequence[CandidateManeuver], plan: CampaignPlan, known: Knowledge) -> str:
    if plan.rule != "information":
        members = window(accepted_estimates(history, plan.rule), plan)
        if members is not None:
            return scattered_most(members, plan.criterion)
    return known.holding_back


def _first_input(aircraft: Aircraft) -> NextInput:
    """Return the advice before any estimate: the textbook's 3-2-1-1, small, timed by the prior model if there
    is one."""
    unit = 0.5
    if set(PARAMETERS) <= set(aircraft.model):
        frequency = ShortPeriod.from_mapping(aircraft.model).natural_frequency
        if np.isfinite(frequency) and frequency > 0.0:
            unit = max(round(0.5 * np.pi / frequency, 1), 0.2)
    travel = travel_of(aircraft, 0.0)
    gentle = StepInput("3-2-1-1", unit, GENTLE * travel, nose_up_first=True)
    return NextInput(f"next: {gentle.spoken(travel)}, to begin gently", None, None, gentle, travel)


def _same_but_better(flown: CandidateManeuver) -> str:
    """Return the advice while no manoeuvre was usable: repeat the input, with the remedy of the newest one's
    first reason."""
    remedy = _remedy(flown)
    return f"the same again, {remedy}" if remedy else "the same again"


def _mend(flown: CandidateManeuver) -> str:
    """Return the remedy for a faulty channel, which comes before any other input; empty where all channels
    are sound."""
    if flown.reasons and (flown.reasons[0].by_instrument or flown.reasons[0].code in NO_CURE_BY_INPUT):
        return _remedy(flown)
    wrong = flown.maneuver.distrusts if flown.maneuver else ()
    return wrong[0].fix if wrong else ""


def _remedy(flown: CandidateManeuver) -> str:
    """Return the remedy that the first reason names; empty without a reason."""
    return flown.reasons[0].text.partition("; ")[2] if flown.reasons else ""
