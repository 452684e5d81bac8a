"""Eqs. (12) and (13): do the last estimates agree."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.decision.paper_rules import scatter_by_parameter, scatter_percent, window
from tests.decision.campaigns import THETA, estimate


def test_one_scattering_parameter_counts_five_standard_deviations_over_its_mean() -> None:
    theta = np.tile(THETA, (3, 1))
    theta[:, 5] = [-4.0, -5.0, -6.0]  # sample standard deviation 1, mean -5
    assert scatter_percent(theta) == pytest.approx(100.0)


def test_the_criterion_is_the_euclidean_norm_over_all_eight_parameters() -> None:
    theta = np.outer([0.9, 1.0, 1.1], THETA)  # every parameter scatters by 10 %
    assert scatter_percent(theta) == pytest.approx(50.0 * np.sqrt(8.0))


def test_the_sign_of_a_mean_does_not_matter() -> None:
    theta = np.random.default_rng(0).normal(1.0, 0.1, (3, 8))
    assert scatter_percent(theta) == pytest.approx(scatter_percent(theta * [1, -1, 1, -1, -1, 1, -1, 1]))


def test_the_written_out_form_takes_squared_deviations_over_n_times_the_mean() -> None:
    theta = np.tile(THETA, (3, 1))
    theta[:, 5] = [-4.0, -5.0, -6.0]
    assert scatter_percent(theta, "eq13") == pytest.approx(100.0 * 5.0 * 2.0 / (3.0 * 5.0))


def test_the_written_out_form_depends_on_units_and_the_default_does_not() -> None:
    theta = np.random.default_rng(1).normal(1.0, 0.1, (3, 8))
    assert scatter_percent(10.0 * theta) == pytest.approx(scatter_percent(theta))
    assert scatter_percent(10.0 * theta, "eq13") == pytest.approx(10.0 * scatter_percent(theta, "eq13"))


def test_a_parameter_whose_mean_is_zero_has_no_scale() -> None:
    theta = np.tile(THETA, (3, 1))
    theta[:, 2] = [-1.0, 0.0, 1.0]
    assert np.isinf(scatter_by_parameter(theta)[2])


def test_equal_estimates_do_not_scatter_even_at_zero() -> None:
    assert scatter_percent(np.zeros((3, 8))) == 0.0


def test_the_window_holds_the_last_n_members_so_that_three_manoeuvres_suffice() -> None:
    plan = CampaignPlan(window=3)
    estimates = [estimate(k * THETA) for k in (1.0, 2.0, 3.0, 4.0)]
    assert window(estimates[:2], plan) is None
    members = window(estimates, plan)
    assert members is not None
    np.testing.assert_allclose(members, [2.0 * THETA, 3.0 * THETA, 4.0 * THETA])


def test_the_window_brings_estimates_to_one_air_speed() -> None:
    fast = THETA * [1.0, 1.2, 1.0, 1.2, 1.0, 1.44, 1.2, 1.44]
    estimates = [estimate(THETA, airspeed_m_s=25.0), estimate(fast, airspeed_m_s=30.0)]
    members = window(estimates, CampaignPlan(window=2))
    assert members is not None
    derivatives = [1, 2, 3, 5, 6, 7]
    np.testing.assert_allclose(members[0, derivatives], members[1, derivatives])
