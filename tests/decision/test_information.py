"""The rule `information`: narrow enough, and the newest manoeuvre predicted."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import CampaignPlan
from advisor.decision.history import Flown
from advisor.decision.information import Z95, knowledge
from advisor.decision.stopping import flight_test
from tests.decision.campaigns import THETA, drawn, estimate, with_change

PLAN = CampaignPlan(rule="information")


def test_one_manoeuvre_is_never_enough_because_nothing_was_predicted() -> None:
    verdict = flight_test([Flown(estimate(std_percent=0.1))], PLAN)
    assert verdict.decision == "continue"
    assert verdict.criterion_percent is not None
    assert verdict.criterion_percent < 100.0
    assert "one more manoeuvre to check the prediction" in verdict.sentence


def test_two_manoeuvres_that_agree_and_are_narrow_stop_the_test() -> None:
    verdict = flight_test([Flown(estimate(std_percent=1.0))] * 2, PLAN)
    assert verdict.decision == "stop"
    assert verdict.limit_percent == 100.0
    assert verdict.stopped_at == 2


def test_an_interval_narrows_with_the_root_of_the_number_of_manoeuvres() -> None:
    one, four = (knowledge([estimate(std_percent=4.0)] * n, PLAN) for n in (1, 4))
    np.testing.assert_allclose(four.belief.std, one.belief.std / 2.0)
    assert four.percent < one.percent


def test_a_tolerance_given_for_one_parameter_is_taken_as_it_stands() -> None:
    plan = replace(PLAN, tolerance={"M_alpha": 0.01})
    known = knowledge([estimate(std_percent=1.0)] * 2, plan)
    assert known.tolerance[5] == 0.01
    assert known.holding_back == "M_alpha"
    assert known.percent == pytest.approx(100.0 * Z95 * 0.0493 / np.sqrt(2.0) / 0.01)


def test_a_manoeuvre_that_was_not_predicted_withholds_the_stop() -> None:
    history = [Flown(estimate(std_percent=0.5))] * 3
    shifted = [*history, Flown(estimate(with_change("M_alpha", 0.95), std_percent=0.5))]
    verdict = flight_test(shifted, PLAN)
    assert verdict.stopped_at == 2
    assert verdict.decision == "continue"


def test_contradicting_manoeuvres_widen_the_intervals() -> None:
    agreeing = knowledge([estimate()] * 4, PLAN)
    contradicting = knowledge([estimate(with_change("M_alpha", k)) for k in (0.9, 1.1, 0.92, 1.08)], PLAN)
    assert (contradicting.belief.std > 2.0 * agreeing.belief.std).all()


def test_good_manoeuvres_are_predicted_in_all_but_about_one_case_in_a_hundred() -> None:
    rng = np.random.default_rng(9)
    surprises = [not knowledge([drawn(rng) for _ in range(3)], PLAN).predicted for _ in range(500)]
    assert np.mean(surprises) < 0.025


def test_the_interval_holds_the_truth_as_often_as_it_says() -> None:
    rng = np.random.default_rng(10)
    inside = []
    for _ in range(300):
        belief = knowledge([drawn(rng) for _ in range(3)], PLAN).belief
        inside.append(np.abs(belief.theta - THETA) < Z95 * belief.std)
    np.testing.assert_allclose(np.mean(inside, axis=0), 0.95, atol=0.04)


def test_a_parameter_that_cannot_be_estimated_keeps_the_test_going() -> None:
    covariance = np.diag((0.01 * THETA) ** 2)
    covariance[2, 2] = np.inf
    verdict = flight_test([Flown(estimate(covariance=covariance))] * 3, PLAN)
    assert verdict.decision == "continue"
    assert verdict.criterion_percent is None
    assert "Z_q" in verdict.sentence


def test_the_parameter_that_holds_the_stop_back_is_named() -> None:
    narrow = flight_test([Flown(estimate())] * 2, replace(PLAN, tolerance={"M_q": 1e-4}))
    assert "M_q" in narrow.sentence


def test_one_estimate_in_a_wrong_minimum_does_not_spoil_the_others() -> None:
    rng = np.random.default_rng(11)
    good = [drawn(rng) for _ in range(5)]
    wrong = estimate(THETA * [1.0, -0.2, -15.0, -15.0, 0.4, -0.1, 2.0, 1.2])
    known = knowledge([wrong, *good], PLAN)
    assert known.left_out == (0,)
    np.testing.assert_allclose(known.belief.theta, knowledge(good, PLAN).belief.theta)
    assert known.predicted


def test_of_two_that_contradict_each_other_neither_is_left_out() -> None:
    known = knowledge([estimate(), estimate(with_change("M_alpha", 0.5))], PLAN)
    assert known.left_out == ()
    assert not known.predicted


def test_a_bolder_manoeuvre_does_not_move_the_goal() -> None:
    zero = THETA * [1.0, 1.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0]
    gentle, bold = estimate(zero, std_percent=2.0), estimate(zero, std_percent=0.2)
    alone, both = knowledge([gentle], PLAN), knowledge([gentle, bold], PLAN)
    assert both.tolerance[2] == pytest.approx(alone.tolerance[2])
    assert both.percent < alone.percent


def test_a_small_error_of_what_no_manoeuvre_could_tell_is_no_knowledge() -> None:
    blind = replace(estimate(), not_identifiable={"M_alpha": "not identifiable while the servo is unknown"})
    verdict = flight_test([Flown(blind)] * 3, PLAN)
    assert verdict.decision == "continue"
    assert verdict.sentence == "CONTINUE: M_alpha not identifiable while the servo is unknown."
    assert flight_test([Flown(blind), Flown(estimate()), Flown(estimate())], PLAN).decision == "stop"
