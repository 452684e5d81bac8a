"""The rule `information`: response and named derivatives known, the newest manoeuvre predicted."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.aircraft.reference import PARAMETERS
from advisor.bundled.study.campaigns import Scene, as_maneuver, fly_named
from advisor.decision.history import CandidateManeuver
from advisor.decision.information import Knowledge
from advisor.decision.information import knowledge as known_from
from advisor.decision.stopping import flight_test
from advisor.oem.estimate import Estimate
from tests.decision.campaigns import THETA, drawn, estimate, with_change

NORMAL_95 = 1.959964
"""Half the width of a 95 % interval of the normal distribution, in standard deviations."""

PLAN = CampaignPlan(rule="information")
UP, DOWN = (as_maneuver(fly_named(Scene(), name)) for name in ("3211", "rev"))


def knowledge(estimates: Sequence[Estimate], plan: CampaignPlan) -> Knowledge:
    """What is known where it is not known what was flown: the named derivatives alone count."""
    return known_from([CandidateManeuver(one) for one in estimates], plan)


def campaign(estimates: Sequence[Estimate]) -> list[CandidateManeuver]:
    """Estimates of 3-2-1-1 and reverse in turn."""
    return [CandidateManeuver(one, maneuver=DOWN if i % 2 else UP) for i, one in enumerate(estimates)]


def with_std(parameter: str, percent: float) -> Estimate:
    """An estimate with errors of half a percent, but of one parameter, in percent of its value."""
    std = 0.005 * np.abs(THETA)
    std[PARAMETERS.index(parameter)] = 0.01 * percent * abs(THETA[PARAMETERS.index(parameter)])
    return estimate(covariance=np.diag(std**2))


def test_one_manoeuvre_is_never_enough_because_nothing_was_predicted() -> None:
    verdict = flight_test([CandidateManeuver(estimate(std_percent=0.1))], PLAN)
    assert verdict.decision == "continue"
    assert verdict.criterion_percent is not None
    assert verdict.criterion_percent < 100.0
    assert "one manoeuvre cannot show its own error" in verdict.sentence


def test_two_manoeuvres_that_agree_and_are_narrow_stop_the_test() -> None:
    verdict = flight_test([CandidateManeuver(estimate(std_percent=1.0))] * 2, PLAN)
    assert verdict.decision == "stop"
    assert verdict.limit_percent == 100.0
    assert verdict.stopped_at == 2


def test_an_interval_narrows_with_the_root_of_the_number_of_manoeuvres() -> None:
    one, four = (knowledge([estimate(std_percent=4.0)] * n, PLAN) for n in (1, 4))
    np.testing.assert_allclose(four.posterior.std, one.posterior.std / 2.0)
    assert four.percent < one.percent


def test_a_tolerance_given_for_one_parameter_is_taken_as_it_stands() -> None:
    plan = replace(PLAN, tolerance={"M_alpha": 0.01})
    known = knowledge([estimate(std_percent=1.0)] * 2, plan)
    assert known.tolerance[5] == 0.01
    assert known.holding_back == "M_alpha"
    assert known.percent == pytest.approx(100.0 * NORMAL_95 * 0.0493 / np.sqrt(2.0) / 0.01)


def test_a_manoeuvre_that_was_not_predicted_withholds_the_stop() -> None:
    history = campaign([estimate(std_percent=0.5)] * 3)
    shifted = [
        *history,
        CandidateManeuver(estimate(with_change("M_alpha", 0.85), std_percent=0.5), maneuver=DOWN),
    ]
    verdict = flight_test(shifted, PLAN)
    assert verdict.stopped_at == 2
    assert verdict.decision == "continue"
    assert "the newest manoeuvre was not predicted" in verdict.sentence


def test_an_error_of_the_model_that_does_not_matter_withholds_no_stop() -> None:
    # Twenty standard deviations by the intervals, two per cent of the response.
    shifted = estimate(with_change("M_alpha", 0.98), std_percent=0.1)
    known = known_from(campaign([estimate(std_percent=0.1)] * 3 + [shifted]), PLAN)
    assert known.surprise > 1.0
    assert 0.0 < known.missed_percent < PLAN.tolerance_percent
    assert known.predicted


def test_the_band_of_the_response_must_be_within_the_tolerance() -> None:
    unsure = campaign([with_std("M_delta_e", 6.0)] * 3)
    any_derivative = replace(PLAN, parameters=())
    known = known_from(unsure, any_derivative)
    # The response is proportional to M_delta_e, but for the share of Z_delta_e.
    expected = NORMAL_95 * 6.0 / np.sqrt(3.0)
    assert known.prediction_percent["q"] == pytest.approx(expected, rel=0.1)
    assert known.percent == pytest.approx(100.0 * max(known.prediction_percent.values()) / 5.0)
    verdict = flight_test(unsure, any_derivative)
    assert verdict.decision == "continue"
    assert "is known only to" in verdict.sentence
    assert flight_test(unsure, replace(any_derivative, tolerance_percent=10.0)).decision == "stop"


def test_a_weak_parameter_that_moves_no_prediction_holds_nobody_up() -> None:
    weak = estimate(THETA * [1, 1, 1, 1e-3, 1, 1, 1, 1], std_percent=1.0)
    verdict = flight_test(campaign([weak] * 3), PLAN)
    assert verdict.decision == "stop"
    assert verdict.evidence[-1] == "judged by the response alone: Z_q, Z_δe"


def test_a_named_parameter_must_be_within_its_own_tolerance() -> None:
    history = campaign([with_std("M_q", 4.0)] * 3)
    assert flight_test(history, replace(PLAN, parameters=("M_alpha",))).decision == "stop"
    held = flight_test(history, replace(PLAN, tolerance={"M_q": 0.05}))
    assert held.decision == "continue"
    assert "the error of M_q" in held.sentence


def test_the_document_tells_what_the_rule_weighs() -> None:
    information = flight_test(campaign([estimate(std_percent=0.5)] * 2), PLAN).by_rule["information"]
    assert set(information.prediction_percent) == {"alpha", "q"}
    assert set(information.parameter_percent) == set(PLAN.parameters)
    last = information.history_percent[-1]
    shares = [*information.parameter_percent.values()]
    shares += [
        100.0 * band / PLAN.tolerance_percent for band in information.prediction_percent.values() if band
    ]
    assert last == pytest.approx(max(share for share in shares if share is not None))


def test_one_gentle_manoeuvre_first_locks_nobody_out() -> None:
    gentle = estimate(with_change("M_delta_e", 1.1), std_percent=15.0, cost=1e-14)
    history = [CandidateManeuver(gentle, maneuver=UP), *campaign([estimate(std_percent=1.0)] * 3)]
    verdict = flight_test(history, PLAN)
    # Nothing sure was known before the second: the third is the first that was predicted.
    assert verdict.stopped_at == 3
    assert verdict.decision == "stop"


def test_contradicting_manoeuvres_widen_the_intervals() -> None:
    agreeing = knowledge([estimate()] * 4, PLAN)
    contradicting = knowledge([estimate(with_change("M_alpha", k)) for k in (0.9, 1.1, 0.92, 1.08)], PLAN)
    assert (contradicting.posterior.std > 2.0 * agreeing.posterior.std).all()


def test_good_manoeuvres_are_predicted_in_all_but_about_one_case_in_a_hundred() -> None:
    rng = np.random.default_rng(9)
    surprises = [not knowledge([drawn(rng) for _ in range(3)], PLAN).predicted for _ in range(500)]
    assert np.mean(surprises) < 0.025


def test_the_interval_holds_the_truth_as_often_as_it_says() -> None:
    rng = np.random.default_rng(10)
    inside = []
    for _ in range(300):
        posterior = knowledge([drawn(rng) for _ in range(3)], PLAN).posterior
        inside.append(np.abs(posterior.theta - THETA) < NORMAL_95 * posterior.std)
    np.testing.assert_allclose(np.mean(inside, axis=0), 0.95, atol=0.04)


def test_a_parameter_that_cannot_be_estimated_keeps_the_test_going() -> None:
    covariance = np.diag((0.01 * THETA) ** 2)
    covariance[6, 6] = np.inf
    for history in (
        [CandidateManeuver(estimate(covariance=covariance))] * 3,
        campaign([estimate(covariance=covariance)] * 3),
    ):
        verdict = flight_test(history, PLAN)
        assert verdict.decision == "continue"
        assert verdict.criterion_percent is None
    assert "M_q" in flight_test(history, replace(PLAN, parameters=("M_q",))).evidence[1]


def test_the_parameter_that_holds_the_stop_back_is_named() -> None:
    narrow = flight_test([CandidateManeuver(estimate())] * 2, replace(PLAN, tolerance={"M_q": 1e-4}))
    assert "M_q" in narrow.sentence


def test_one_estimate_in_a_wrong_minimum_does_not_spoil_the_others() -> None:
    rng = np.random.default_rng(11)
    good = [drawn(rng) for _ in range(5)]
    wrong = estimate(THETA * [1.0, -0.2, -15.0, -15.0, 0.4, -0.1, 2.0, 1.2])
    known = knowledge([wrong, *good], PLAN)
    assert known.left_out == (0,)
    np.testing.assert_allclose(known.posterior.theta, knowledge(good, PLAN).posterior.theta)
    assert known.predicted


def test_of_two_that_contradict_each_other_neither_is_left_out() -> None:
    known = knowledge([estimate(), estimate(with_change("M_alpha", 0.5))], PLAN)
    assert known.left_out == ()
    assert not known.predicted


def test_a_bolder_manoeuvre_does_not_move_the_goal() -> None:
    zero = THETA * [1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    gentle, bold = estimate(zero, std_percent=2.0), estimate(zero, std_percent=0.2)
    plan = replace(PLAN, parameters=("Z_q",))
    alone, both = knowledge([gentle], plan), knowledge([gentle, bold], plan)
    assert both.tolerance[2] == pytest.approx(alone.tolerance[2])
    assert both.percent < alone.percent


def test_a_small_error_of_what_no_manoeuvre_could_tell_is_no_knowledge() -> None:
    blind = replace(estimate(), not_identifiable={"M_alpha": "not identifiable while the servo is unknown"})
    verdict = flight_test([CandidateManeuver(blind)] * 3, PLAN)
    assert verdict.decision == "continue"
    assert verdict.sentence == "CONTINUE: M_α not identifiable while the servo is unknown."
    assert (
        flight_test(
            [CandidateManeuver(blind), CandidateManeuver(estimate()), CandidateManeuver(estimate())], PLAN
        ).decision
        == "stop"
    )
