"""Posterior along a parameter whose linear interval is no interval of the posterior."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.oem import estimator
from advisor.oem.profile import Posterior, Profile, profiled
from benchmarks.accuracy import clean, flown

STD = 0.04
"""Standard deviation of the profiled lag at its optimum, s."""
LAG = 0.06
KNOWN = Aircraft(elevator=Elevator(lag_s=0.0))


def profile(derivative, nats, values=None):
    """Return the profile of one derivative and the lag, from functions of the lag."""
    values = LAG + STD * np.arange(-4.0, 5.0) if values is None else values
    theta = np.column_stack([derivative(values), values])
    return Profile(values, nats(values), theta, np.array([derivative(LAG), LAG]))


def parabola(lag):
    return 0.5 * ((lag - LAG) / STD) ** 2


def test_on_a_parabola_with_a_straight_derivative_the_moment_is_the_linear_variance():
    found = profile(lambda lag: 100.0 * lag, parabola).moment
    assert np.allclose(np.diag(found), [(100.0 * STD) ** 2, STD**2], rtol=0.02)


def test_a_derivative_that_is_flat_at_the_optimum_and_bends_has_the_error_of_the_bend():
    found = profile(lambda lag: -30.0 - 4000.0 * (lag - LAG) ** 2, parabola)
    reach = 4000.0 * (1.959964 * STD) ** 2
    assert 1.959964 * np.sqrt(found.moment[0, 0]) >= 0.99 * reach


def test_a_flat_ridge_to_one_side_reaches_to_its_end():
    def nats(lag):
        return np.where(lag > LAG, 0.1 * (lag - LAG) / STD, parabola(lag))

    found = profile(lambda lag: -30.0 - 200.0 * (lag - LAG), nats)
    assert 1.959964 * np.sqrt(found.moment[0, 0]) >= 0.999 * 200.0 * 4.0 * STD


def test_neighbours_far_below_the_optimum_leave_the_interval_of_the_optimum():
    found = profile(lambda lag: 100.0 * lag, lambda lag: 1e4 * parabola(lag))
    assert np.all(np.isfinite(found.moment))
    steep = 1.959964 * STD / 100.0
    assert 1.959964 * np.sqrt(found.moment[0, 0]) == pytest.approx(100.0 * steep, rel=0.01)


def test_the_ends_of_the_interval_lie_between_the_nodes():
    alike = profile(lambda lag: lag, parabola).alike
    assert np.isclose(np.max(alike[:, 0]), LAG + 1.959964 * STD, rtol=1e-6)


class Lag:
    """A lag between 0 and 0.4 s without a prior, whose problem is its value."""

    name, prior = "servo_lag_s", None

    def read(self, problem):
        return problem

    def moved(self, problem, change):
        return min(max(problem + change, 0.0), 0.4)


def at(lag, theta, cost, std=STD):
    from advisor.oem.solution import Solution

    covariance = np.diag([1e-4, std**2])
    return Solution(
        problem=lag, assembly=SimpleNamespace(names=SimpleNamespace(places=[(True, 0)])),
        optimum=SimpleNamespace(log_likelihood_cost=cost, shared=[theta], local=np.zeros((1, 1))),
        influence=None,
        theta=np.array([theta]), covariance_cr=covariance, covariance=covariance, noise=None,
        contributions=np.zeros((1, 2)), systematic=np.zeros((2, 2)),
    )  # fmt: skip


def walked(theta, cost, asked=None, std=STD):
    """Return the solution with its posterior along the lag, for optima given by functions of the lag."""

    def refit(_, problem, near):
        if asked is not None:
            asked.append(problem)
        return at(problem, theta(problem), cost(problem))

    lag = Lag()
    return profiled(at(LAG, theta(LAG), cost(LAG), std), lag, Posterior((lag,), 1.0), refit)


def test_a_solution_on_a_ridge_has_the_interval_of_the_ridge():
    found = walked(lambda lag: -30.0 - 4000.0 * (lag - LAG) ** 2, lambda lag: 2.0 * parabola(lag))
    std = float(np.sqrt(found.widened[0, 0]))
    assert 1.959964 * std >= 0.99 * 4000.0 * (1.959964 * STD) ** 2


def test_the_walk_ends_at_the_end_of_the_range_and_where_the_density_has_fallen():
    asked = []
    walked(lambda lag: lag, lambda lag: 2.0 * parabola(lag), asked)
    assert min(asked) == 0.0
    assert max(asked) <= LAG + 3.1 * STD
    assert len(asked) <= 6


@pytest.mark.parametrize(("std", "needed"), [(0.01, False), (0.03, False), (0.031, True), (0.1, True)])
def test_a_profile_is_needed_where_the_interval_of_the_lag_reaches_zero(std, needed):
    found = walked(lambda lag: lag, lambda lag: ((lag - LAG) / std) ** 2, std=std)
    assert (found.alike is not None) is needed


def test_a_parabola_leaves_the_interval_as_it_is():
    found = walked(lambda lag: 0.0 * lag, lambda lag: 2.0 * parabola(lag))
    assert np.isclose(found.widened[0, 0], 1e-4, rtol=1e-6)


def test_the_response_to_the_flown_input_is_predicted_alike_along_the_ridge(monkeypatch):
    """The band of a record on a ridge is that of its own hill, whatever the derivatives' intervals are."""
    widths = []
    monkeypatch.setattr(estimator, "prediction_band", lambda *found: widths.append(found[2]) or {})
    monkeypatch.setattr(estimator, "notes", lambda *_, **__: ())
    for alike in (None, np.zeros((1, 1))):
        fit = estimator.fit_jointly([flown(1, clean()[2])], KNOWN)
        wide = 100.0 * np.eye(len(fit.fitted.solution.covariance))
        on_ridge = replace(fit.fitted.solution, alike=alike, modes=None if alike is None else wide)
        estimator.report(on_ridge, fit.prepared, KNOWN)
    assert np.allclose(widths[0], widths[1])
