"""The change test over flights names the first flight after the change and what moved."""

from dataclasses import replace

import numpy as np

from advisor.aircraft.reference import PARAMETERS
from advisor.batch.flight import Analyzed
from advisor.batch.trend import change_over_flights, lying_apart
from advisor.oem.estimate import Estimate

THETA = np.array([-0.009, -0.483, 0.104, 0.676, 0.475, -4.93, -2.01, -7.21])
STD = 0.01 * np.abs(THETA)


def flight(seed: int, elevator: float = 1.0) -> Estimate:
    """A joint estimate with an error of 1 % in each parameter; the elevator's moment is scaled."""
    theta = THETA + STD * np.random.default_rng(seed).standard_normal(8)
    theta[PARAMETERS.index("M_delta_e")] *= elevator
    covariance = np.diag(STD**2)
    return Estimate(theta, covariance, covariance, 1.0, (), 1, {}, (), 1.0, 25.0)


def test_a_loss_of_the_elevators_moment_is_told_since_its_first_flight() -> None:
    flights = [(n, flight(n, 1.0 if n < 17 else 0.85)) for n in range(11, 23)]
    found = change_over_flights(flights)
    assert found is not None
    assert found.since == 17
    assert [moved.parameter for moved in found.change.moved] == ["M_delta_e"]
    assert found.sentence.startswith("Since flight 17 M_δe is 15 % smaller")
    assert "a loss of the elevator's moment" in found.sentence


def test_flights_that_differ_by_their_errors_show_no_change() -> None:
    assert change_over_flights([(n, flight(n)) for n in range(1, 13)]) is None


def test_two_flights_are_too_few_for_a_change() -> None:
    assert change_over_flights([(1, flight(1)), (2, flight(2, 0.5))]) is None


def test_two_flights_whose_intervals_lie_apart_are_told() -> None:
    told = lying_apart([(4, flight(1)), (7, flight(2, 0.5))])
    assert told.startswith("M_δe of flights 4 and 7 lies apart: −7.")
    assert told.count("±") == 2


def test_flights_whose_intervals_overlap_are_not_told_apart() -> None:
    assert lying_apart([(1, flight(1)), (2, flight(2))]) == ""


def test_an_estimate_that_was_kept_is_compared_as_it_was() -> None:
    estimate = replace(flight(3), covariance=np.diag([np.inf, *STD[1:] ** 2]))
    joint = {
        "theta": estimate.theta.tolist(),
        "covariance": [[None if not np.isfinite(v) else v for v in row] for row in estimate.covariance],
        "covariance_cr": estimate.covariance_cr.tolist(),
        "airspeed_m_s": 25.0,
    }
    again = Analyzed("a.tlog", "", "", 0.0, {}, joint).estimate
    assert again is not None
    np.testing.assert_array_equal(again.theta, estimate.theta)
    np.testing.assert_array_equal(np.isfinite(again.covariance), np.isfinite(estimate.covariance))
