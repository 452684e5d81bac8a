"""May we stop: Eq. (12) over the accepted manoeuvres, every rule side by side."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan, Rule
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import CriterionCourse
from advisor.decision.paper_rules import scatter_percent
from advisor.decision.stopping import flight_test
from advisor.decision.verdict import Reason
from tests.decision.campaigns import THETA, drawn, estimate, flown, with_change

PLAN = CampaignPlan(rule="continuous")


@pytest.mark.parametrize("rule", ["continuous", "separate", "information"])
def test_without_a_manoeuvre_every_rule_says_that_no_test_input_has_been_flown(rule) -> None:
    verdict = flight_test([], CampaignPlan(rule=rule))
    assert verdict.decision == "continue"
    assert verdict.criterion_percent is None
    assert verdict.sentence == "No test input of the elevator has been flown."


@pytest.mark.parametrize(
    ("n", "said"),
    [
        (1, "The one input of the elevator cannot be used."),
        (2, "None of the 2 inputs of the elevator can be used."),
    ],
)
def test_where_no_manoeuvre_is_usable_the_sentence_gives_no_order(n, said) -> None:
    banked = CandidateManeuver(estimate(THETA), (Reason("bank", "bank reached 43 deg", 43.0, 30.0),))
    assert flight_test([banked] * n, PLAN).sentence == said


def test_three_agreeing_manoeuvres_stop_the_test() -> None:
    history = [CandidateManeuver(estimate(k * THETA)) for k in (0.99, 1.0, 1.01)]
    verdict = flight_test(history, PLAN)
    assert verdict.decision == "stop"
    assert verdict.stopped_at == 3
    assert verdict.criterion_percent == pytest.approx(5.0 * np.sqrt(8.0))
    assert verdict.by_rule["continuous"].history_percent == (None, None, verdict.criterion_percent)
    assert verdict.sentence.startswith("TEST COMPLETE: the last 3 accepted manoeuvres agree within 14 %")


def test_scattering_manoeuvres_continue_and_the_worst_parameter_is_named() -> None:
    history = [CandidateManeuver(estimate(with_change("Z_q", k))) for k in (0.5, 1.0, 1.5)]
    verdict = flight_test(history, PLAN)
    assert verdict.decision == "continue"
    assert verdict.stopped_at is None
    assert "Z_q scatters most" in verdict.sentence


def test_the_window_holds_the_manoeuvres_its_own_rule_accepted() -> None:
    costs = [1.0, 0.9, 1.5, 0.8, 0.7]
    history = [
        CandidateManeuver(estimate(k * THETA, cost=c))
        for k, c in zip((1.0, 1.01, 9.0, 1.02, 1.03), costs, strict=True)
    ]
    by_rule = flight_test(history, PLAN).by_rule
    # `separate` refuses the third, so its window of three is manoeuvres 1, 2, 4.
    assert by_rule["separate"].stopped_at == 4
    assert by_rule["separate"].history_percent[3] == pytest.approx(
        scatter_percent(np.outer([1.0, 1.01, 1.02], THETA))
    )
    # `continuous` accepts it and has it in its window until the end.
    assert by_rule["continuous"].stopped_at is None


def test_a_refused_manoeuvre_leaves_the_criterion_where_it_was() -> None:
    history = [CandidateManeuver(estimate(k * THETA)) for k in (0.99, 1.0, 1.01)]
    after = [*history, CandidateManeuver(estimate(9.0 * THETA, cost=1.0))]
    verdict = flight_test(after, PLAN)
    assert verdict.decision == "stop"
    assert verdict.stopped_at == 3
    assert verdict.by_rule["continuous"].history_percent[3] == verdict.criterion_percent


def test_a_later_contradiction_takes_the_stop_back_and_says_so() -> None:
    history = [CandidateManeuver(estimate(k * THETA)) for k in (0.99, 1.0, 1.01, 2.0)]
    verdict = flight_test(history, PLAN)
    assert verdict.decision == "continue"
    assert verdict.stopped_at == 3
    assert verdict.sentence.startswith("CONTINUE: later manoeuvres contradict the stop after manoeuvre 3; ")
    assert not any("stop" in w for w in verdict.warnings)


def test_excluding_the_contradiction_gives_the_stop_again() -> None:
    history = [CandidateManeuver(estimate(k * THETA)) for k in (0.99, 1.0, 1.01, 2.0)]
    history[3] = replace(history[3], excluded_because="flaps were down")
    assert flight_test(history, PLAN).decision == "stop"


def test_window_and_limit_are_the_users() -> None:
    history = [CandidateManeuver(estimate(k * THETA)) for k in (0.99, 1.01)]
    assert flight_test(history, replace(PLAN, window=2)).decision == "stop"
    assert flight_test(history, replace(PLAN, window=2, limit_percent=1.0)).decision == "continue"


def test_the_written_out_form_is_available_by_name() -> None:
    history = [CandidateManeuver(estimate(with_change("M_alpha", k))) for k in (0.9, 1.0, 1.1)]
    assert flight_test(history, PLAN).decision == "continue"
    assert flight_test(history, replace(PLAN, criterion="eq13")).decision == "stop"


def test_a_parameter_near_zero_keeps_the_papers_criterion_up() -> None:
    rng = np.random.default_rng(8)
    near_zero = THETA.copy()
    near_zero[2] = 0.0
    history = [CandidateManeuver(drawn(rng, near_zero, std_percent=2.0)) for _ in range(6)]
    assert flight_test(history, PLAN).decision == "continue"
    assert flight_test(history, replace(PLAN, rule="information")).decision == "stop"


def test_every_rule_runs_whichever_is_chosen() -> None:
    history = flown([1.0, 0.9, 0.8])
    for rule in ("continuous", "separate", "information"):
        verdict = flight_test(history, replace(PLAN, rule=rule))
        assert set(verdict.by_rule) == {"continuous", "separate", "information"}
        assert all(len(p.history_percent) == 3 for p in verdict.by_rule.values())
        assert verdict.stopped_at == verdict.by_rule[rule].stopped_at
        assert verdict.limit_percent == verdict.by_rule[rule].limit_percent


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
