"""How well a parameter must be known."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import CampaignPlan
from advisor.decision.tolerance import tolerances, unnoticeable_change
from tests.decision.campaigns import NOISE, SAMPLES, THETA, estimate

PLAN = CampaignPlan(rule="information")


def test_a_derivatives_own_tolerance_is_twice_the_predictions_and_of_damping_four_times() -> None:
    # At 0.1 % error per manoeuvre, what the noise hides is far below every parameter.
    derivatives = [1, 2, 3, 5, 6, 7]
    for percent in (5.0, 10.0):
        allowed = tolerances(THETA, estimate(std_percent=0.1), replace(PLAN, tolerance_percent=percent))
        share = 0.01 * percent * np.array([2.0, 4.0, 2.0, 2.0, 4.0, 2.0])
        np.testing.assert_allclose(allowed[derivatives], share * np.abs(THETA[derivatives]))


def test_the_unnoticeable_change_moves_the_response_by_the_noise() -> None:
    # 1/std² is the information of 2·SAMPLES measurements.
    hidden = 0.01 * np.abs(THETA) * np.sqrt(2 * SAMPLES)
    np.testing.assert_allclose(unnoticeable_change(estimate(std_percent=1.0)), hidden)


def test_a_parameter_at_zero_is_allowed_what_the_noise_hides() -> None:
    first = estimate(std_percent=1.0)
    zero = THETA.copy()
    zero[2] = 0.0
    assert tolerances(zero, first, PLAN)[2] == pytest.approx(unnoticeable_change(first)[2])


def test_the_allowance_near_zero_fades_continuously_into_the_percentage() -> None:
    first = estimate(std_percent=1.0)
    hidden = unnoticeable_change(first)[2]
    allowed = []
    for size in np.linspace(0.0, 5.0, 501) * hidden:
        theta = THETA.copy()
        theta[2] = size
        allowed.append(tolerances(theta, first, PLAN)[2])
    assert np.max(np.abs(np.diff(allowed))) < 0.01 * hidden
    assert allowed[-1] == pytest.approx(0.2 * 5.0 * hidden)


def test_the_constants_may_be_wrong_by_what_the_noise_hides_of_the_trim() -> None:
    zero = THETA * [0.0, 1.0, 1.0, 1.0, 0.0, 1.0, 1.0, 1.0]
    allowed = tolerances(zero, estimate(std_percent=0.001), PLAN)
    assert allowed[0] == pytest.approx(abs(THETA[1]) * NOISE)
    assert allowed[4] == pytest.approx(abs(THETA[5]) * NOISE)


def test_a_tolerance_given_by_name_stands_above_everything() -> None:
    plan = replace(PLAN, tolerance={"Z_q": 0.2, "M_alpha": 0.01})
    allowed = tolerances(THETA, estimate(), plan)
    assert (allowed[2], allowed[5]) == (0.2, 0.01)


def test_where_no_angle_of_attack_is_measured_the_constants_have_a_tolerance_all_the_same() -> None:
    first = estimate()
    blind = replace(first, fits=({"q": first.fits[0]["q"]},))
    assert np.all(tolerances(THETA, blind, PLAN) > 0.0)
