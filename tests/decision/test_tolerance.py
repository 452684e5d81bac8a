"""How well a parameter must be known."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import CampaignPlan
from advisor.bundled.study.campaigns import Scene, as_maneuver, fly_named
from advisor.decision.history import CandidateManeuver
from advisor.decision.pooling import DERIVATIVES
from advisor.decision.prediction import Prediction, missed_percent, predict, tolerances
from advisor.process.arrays import FloatArray
from tests.decision.campaigns import THETA, estimate

PLAN = CampaignPlan(rule="information")
ONE = CandidateManeuver(estimate(), maneuver=as_maneuver(fly_named(Scene(), "3211")))
UNKNOWN = Prediction({})
INSIDE = list(DERIVATIVES)


def with_z_q(value: float) -> FloatArray:
    """The reference aircraft with another Z_q."""
    theta = THETA.copy()
    theta[2] = value
    return theta


def allowed(theta: FloatArray, plan: CampaignPlan = PLAN) -> FloatArray:
    return tolerances(theta, predict([ONE], theta[INSIDE], None), plan)


def test_a_derivatives_own_tolerance_is_at_least_twice_the_predictions() -> None:
    for percent in (5.0, 10.0):
        asked = tolerances(THETA, UNKNOWN, replace(PLAN, tolerance_percent=percent))
        assert np.all(asked >= 0.02 * percent * np.abs(THETA) - 1e-12)
        assert asked[7] == pytest.approx(0.02 * percent * abs(THETA[7]))


def test_a_damping_that_is_a_small_part_of_all_damping_is_allowed_what_moves_the_damping() -> None:
    little = THETA.copy()
    little[1], little[6] = -8.0, -2.0
    asked = tolerances(little, UNKNOWN, PLAN)
    assert asked[6] == pytest.approx(0.05 * 10.0)


def test_a_derivative_at_zero_is_allowed_what_moves_the_response_by_its_tolerance() -> None:
    zero = with_z_q(0.0)
    off = with_z_q(allowed(zero)[2])
    assert missed_percent(ONE, off[INSIDE], zero[INSIDE], None) == pytest.approx(5.0, rel=0.1)


def test_the_allowance_near_zero_fades_continuously_into_the_percentage() -> None:
    enough = allowed(with_z_q(0.0))[2]
    found = np.array([allowed(with_z_q(size))[2] for size in np.linspace(0.0, 4.0, 81) * enough])
    assert np.max(np.abs(np.diff(found))) < 0.05 * enough
    assert found[-1] == pytest.approx(0.1 * 4.0 * enough)


def test_a_poor_manoeuvre_does_not_widen_what_is_asked_for() -> None:
    poor = replace(ONE, estimate=estimate(std_percent=50.0))
    np.testing.assert_allclose(tolerances(THETA, predict([poor], THETA[INSIDE], None), PLAN), allowed(THETA))


def test_a_tolerance_given_by_name_stands_above_everything() -> None:
    asked = allowed(THETA, replace(PLAN, tolerance={"Z_q": 0.2, "M_alpha": 0.01}))
    assert (asked[2], asked[5]) == (0.2, 0.01)
