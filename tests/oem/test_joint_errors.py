"""Errors of a joint estimate: those of the manoeuvres together, neither of one alone nor of none."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.scatter_between import widened_by_scatter
from tests.oem.builders import UAV, flown

KNOWN = Aircraft(elevator=Elevator(lag_s=0.0))
TOGETHER = 4


@pytest.fixture(scope="module")
def flights():
    return [
        flown(UAV, noise=0.02, length_s=8.0, rate_hz=25.0, unit_s=0.3, seed=seed) for seed in range(TOGETHER)
    ]


@pytest.fixture(scope="module")
def joint(flights):
    return estimate_jointly(flights, KNOWN)


def test_four_times_the_same_manoeuvre_halves_every_error_of_the_force(flights):
    """Alike manoeuvres bring their information each, so that the variance falls as 1/n."""
    one, four = estimate(flights[0], KNOWN), estimate_jointly(flights[:1] * TOGETHER, KNOWN)
    expected = np.diag(one.covariance_cr)[:4] / TOGETHER
    assert np.diag(four.covariance_cr)[:4] == pytest.approx(expected, rel=0.05)


def test_the_prior_of_the_command_counts_once_for_all_manoeuvres(flights):
    """The delay of the command moves the moment's derivatives, and its prior brings no information again."""
    one, four = estimate(flights[0], KNOWN), estimate_jointly(flights[:1] * TOGETHER, KNOWN)
    share = np.diag(four.covariance_cr)[4:] / np.diag(one.covariance_cr)[4:]
    assert np.all((share > 0.99 / TOGETHER) & (share < 1.0)), share


def test_stated_errors_of_white_noise_are_those_of_the_bound(joint):
    """Coloured noise and scatter may widen an error, and white noise gives them little reason to."""
    ratio = np.sqrt(np.diag(joint.covariance) / np.diag(joint.covariance_cr))
    assert np.all((ratio > 0.8) & (ratio < 1.5)), ratio


def test_the_truth_lies_within_three_stated_errors(joint):
    assert np.all(np.abs(joint.theta - UAV) < 3.0 * np.sqrt(np.diag(joint.covariance)))


def test_scatter_of_four_manoeuvres_is_their_variance_over_four():
    """The contributions of m manoeuvres to a mean are d/m, and its squared error is Σd²/(m·(m - 1))."""
    departures = np.array([[3.0], [-3.0], [5.0], [-5.0]])
    widened = widened_by_scatter(np.array([[0.1]]), departures / 4.0)
    assert widened[0, 0] == pytest.approx(np.sum(departures**2) / (4.0 * 3.0))


def test_scatter_that_chance_explains_widens_nothing():
    """χ² of three degrees of freedom is below 7.81 in 95 % of cases."""
    stated = np.array([[1.0]])
    for square, factor in ((7.7, 1.0), (7.9, 7.9 / 3.0)):
        contributions = 0.25 * np.sqrt(square) * np.array([[1.0], [-1.0], [1.0], [-1.0]])
        assert widened_by_scatter(stated, contributions)[0, 0] == pytest.approx(factor)
