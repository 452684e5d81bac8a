"""A manoeuvre in buffet or stall is left out: beyond the others' angle of attack, and another aircraft."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.history import CandidateManeuver
from advisor.decision.judge import judge_campaign
from tests.decision.campaigns import at_alpha, estimate, with_change

PLAN = CampaignPlan()
STALLED = estimate(with_change("M_q", 0.65))


def codes(*estimates):
    verdicts = judge_campaign([CandidateManeuver(one) for one in estimates], PLAN)
    return [reason.code for verdict in verdicts for reason in verdict.reasons]


def normal(n, low_deg=2.0, high_deg=6.0):
    return [at_alpha(estimate(), low_deg + 0.1 * k, high_deg + 0.1 * k) for k in range(n)]


@pytest.mark.parametrize("others", [2, 3, 6])
def test_another_aircraft_beyond_the_others_angle_of_attack_is_left_out(others):
    assert codes(*normal(others), at_alpha(STALLED, 8.0, 12.0)) == ["alpha_range"]


def test_the_order_flown_does_not_matter():
    assert codes(at_alpha(STALLED, 8.0, 12.0), *normal(2)) == ["alpha_range"]


def test_the_sentence_names_both_angles_of_attack_and_the_next_step():
    history = [CandidateManeuver(one) for one in (*normal(2, 2.0, 6.0), at_alpha(STALLED, 8.0, 12.0))]
    sentence = judge_campaign(history, PLAN)[-1].sentence
    assert "flown about 10.0 deg of alpha (the others: 2.0 to 6.1)" in sentence
    assert sentence.endswith("fly it at their angle of attack")


def test_two_stalls_do_not_hide_each_other():
    assert (
        codes(*normal(3), at_alpha(STALLED, 8.0, 12.0), at_alpha(STALLED, 5.0, 15.0)) == ["alpha_range"] * 2
    )


def test_an_aircraft_that_is_linear_beyond_the_others_counts():
    assert codes(*normal(3), at_alpha(estimate(), 8.0, 12.0)) == []


def test_a_contradiction_within_the_others_angle_of_attack_has_another_reason():
    assert codes(*normal(4), at_alpha(STALLED, 3.0, 7.0)) == ["odd"]


def test_a_larger_test_about_the_others_angle_of_attack_is_not_beyond_it():
    assert codes(*normal(2), at_alpha(STALLED, -2.0, 11.0)) == []


def test_of_two_manoeuvres_nobody_knows_which_is_beyond():
    assert codes(*normal(1), at_alpha(STALLED, 8.0, 12.0)) == []


def test_others_that_scatter_as_much_leave_nothing_out():
    scattered = [at_alpha(estimate(with_change("M_q", by)), 2.0, 6.0) for by in (0.7, 1.0, 1.3)]
    assert codes(*scattered, at_alpha(STALLED, 8.0, 12.0)) == []


def test_without_a_measured_angle_of_attack_nothing_is_beyond():
    blind = [replace(one, fits=({"q": one.fits[0]["q"]},)) for one in (estimate(), estimate(), STALLED)]
    assert codes(*blind) == []
