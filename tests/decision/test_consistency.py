"""Manoeuvres that contradict all others: by significance, with the others' scatter as the scale, and in
size."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.consistency import outliers
from advisor.decision.pooling import posteriors_at_one_speed
from tests.campaign.side_builders import estimate as side_estimate
from tests.decision.campaigns import THETA, drawn, estimate, with_change

PLAN = CampaignPlan()


def odd(*thetas, plan=PLAN, std_percent=0.1):
    return list(
        outliers(posteriors_at_one_speed([estimate(t, std_percent=std_percent) for t in thetas]), plan)
    )


def test_a_difference_far_beyond_the_stated_errors_but_within_the_tolerance_is_no_outlier():
    assert odd(THETA, THETA, THETA, with_change("M_alpha", 1.08)) == []


def test_a_difference_in_size_is_an_outlier():
    assert odd(THETA, THETA, THETA, with_change("M_alpha", 1.15)) == [3]


def test_the_tolerance_in_the_file_decides_what_is_a_difference_in_size():
    wide = replace(PLAN, tolerance={"M_alpha": 0.2 * 4.93})
    assert odd(THETA, THETA, THETA, with_change("M_alpha", 1.15), plan=wide) == []
    strict = replace(PLAN, tolerance_percent=2.0)
    assert odd(THETA, THETA, THETA, with_change("M_alpha", 1.08), plan=strict) == [3]


def test_a_derivative_that_the_crew_does_not_judge_makes_no_outlier():
    assert odd(THETA, THETA, THETA, with_change("Z_q", 3.0)) == []


@pytest.mark.parametrize("scatter", [6.0, 10.0])
def test_others_that_scatter_beyond_their_stated_errors_are_the_scale_of_the_distance(scatter):
    rng = np.random.default_rng(5)
    others = [drawn(rng, std_percent=scatter).theta for _ in range(3)]
    assert odd(*others, with_change("M_alpha", 1.3)) == []


def test_chance_makes_an_outlier_of_one_manoeuvre_in_a_thousand_at_most_one_campaign_in_a_hundred():
    rng = np.random.default_rng(11)
    campaigns = [posteriors_at_one_speed([drawn(rng, std_percent=6.0) for _ in range(5)]) for _ in range(200)]
    assert sum(bool(outliers(one, PLAN)) for one in campaigns) <= 2


def test_an_aileron_test_does_not_contradict_a_rudder_test_about_the_rudder():
    aileron, rudder = side_estimate("aileron", percent=1.0), side_estimate("rudder", percent=1.0)
    # A control at rest leaves its derivatives at the prior's mean, with hardly an error.
    still = [aileron.names.index(name) for name in ("Y_delta_r", "L_delta_r", "N_delta_r")]
    theta, covariance = aileron.theta.copy(), aileron.covariance.copy()
    theta[still], covariance[still, still] = 0.0, 1e-10
    aileron = replace(aileron, theta=theta, covariance=covariance, covariance_cr=covariance)
    plan = replace(PLAN, parameters=("L_p", "N_delta_r"))
    assert outliers(posteriors_at_one_speed([aileron, aileron, rudder, aileron]), plan) == {}
