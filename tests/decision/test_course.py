"""What is kept from one decision to the next changes no decision."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan, Rule
from advisor.decision.course import CriterionCourse
from advisor.decision.history import CandidateManeuver
from advisor.decision.stopping import flight_test
from tests.decision.campaigns import drawn, estimate


@pytest.fixture
def history() -> list[CandidateManeuver]:
    rng = np.random.default_rng(11)
    costs = 1e-9 * np.exp(0.5 * rng.standard_normal(12))
    return [CandidateManeuver(replace(drawn(rng), cost=float(cost))) for cost in costs]


@pytest.mark.parametrize("rule", ["information", "continuous", "separate"])
def test_decisions_with_a_course_are_those_without(history: list[CandidateManeuver], rule: Rule) -> None:
    plan = CampaignPlan(rule=rule)
    course = CriterionCourse(plan)
    for n in range(1, len(history) + 1):
        assert flight_test(history[:n], plan, course=course) == flight_test(history[:n], plan)


@pytest.mark.parametrize("rule", ["information", "continuous"])
def test_excluding_an_earlier_manoeuvre_decides_all_that_followed_again(history, rule):
    plan = CampaignPlan(rule=rule)
    course = CriterionCourse(plan)
    before = flight_test(history, plan, course=course)
    excluded = [*history[:3], replace(history[3], excluded_because="gust"), *history[4:]]
    assert flight_test(excluded, plan, course=course) == flight_test(excluded, plan) != before
    assert flight_test(history, plan, course=course) == before


def test_one_more_manoeuvre_leaves_what_stands_before_it(history: list[CandidateManeuver]) -> None:
    course = CriterionCourse(CampaignPlan())
    course.standing(history)
    earlier = [course.standing(history[:n]) for n in range(1, len(history) + 1)]
    course.standing([*history, CandidateManeuver(estimate())])
    assert all(course.standing(history[:n]) is earlier[n - 1] for n in range(1, len(history) + 1))
