"""Manoeuvres that contradict all others: by significance, with the others' scatter as the scale, and in
size."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.consistency import outliers
from advisor.decision.pooling import posteriors_at_one_speed
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
