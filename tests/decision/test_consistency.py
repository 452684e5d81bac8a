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
from tests.rows import row

PLAN = CampaignPlan()


def odd(*thetas, plan=PLAN, std_percent=0.1):
    return list(
        outliers(posteriors_at_one_speed([estimate(t, std_percent=std_percent) for t in thetas]), plan)
    )


WIDE = replace(PLAN, tolerance={"M_alpha": 0.2 * 4.93})
STRICT = replace(PLAN, tolerance_percent=2.0)


@row("a difference within the tolerance is no outlier", "M_alpha", 1.08, PLAN, [])
@row("a difference in size is an outlier", "M_alpha", 1.15, PLAN, [3])
@row("a difference within a wider tolerance is no outlier", "M_alpha", 1.15, WIDE, [])
@row("a difference beyond a stricter tolerance is an outlier", "M_alpha", 1.08, STRICT, [3])
@row("a derivative that the crew does not judge is no outlier", "Z_q", 3.0, PLAN, [])
def test_a_manoeuvre_that_differs_from_three_others_is_an_outlier(name, factor, plan, found):
    assert odd(THETA, THETA, THETA, with_change(name, factor), plan=plan) == found


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
