import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.oem.estimator import estimate, fit_jointly
from advisor.oem.prepare import prepare
from advisor.oem.solution import solve
from tests.oem.builders import UAV, maneuver, simulate, trim_alpha, trim_elevator

PERIOD = 0.02


def smooth_flight(early_s, held, seed=1, noise=0.01):
    """Return a manoeuvre of the small aircraft whose smooth command acts ``early_s`` before its stamps."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, PERIOD)
    u = trim_elevator(UAV) + 0.01 * (np.sin(3.0 * t) + np.sin(7.0 * t) + np.sin(11.0 * t))
    fine = np.arange(0.0, 8.0 - 2.0 * PERIOD, 0.001)
    acting = fine + early_s
    command = u[np.searchsorted(t, acting + 1e-9, side="right") - 1] if held else np.interp(acting, t, u)
    stamps = t[1:-3] + 0.007
    x = simulate(UAV, [trim_alpha(UAV), 0.0], fine, command, stamps)
    off = noise * x[:, :2].std(axis=0) * rng.standard_normal((len(x), 2))
    channels = {"alpha": (stamps, x[:, 0] + off[:, 0]), "q": (stamps, x[:, 1] + off[:, 1])}
    return maneuver(1, (t, u), channels)


@pytest.mark.parametrize(("early_s", "held"), [(0.005, True), (0.014, True), (-0.006, False), (0.006, False)])
def test_a_smooth_command_recorded_early_or_late_does_not_pass_for_other_derivatives(early_s, held):
    found = estimate(smooth_flight(early_s, held), Aircraft(elevator=Elevator(lag_s=0.0)))
    assert np.all(np.abs(found.theta - UAV) < 3.5 * found.std)
    assert any("acts" in note for note in found.notes)


@pytest.mark.parametrize("held", [True, False])
def test_a_smooth_command_is_fitted_as_it_was_flown(held):
    flight = smooth_flight(0.0, held, noise=0.0005)
    fit = fit_jointly([flight], Aircraft(elevator=Elevator(lag_s=0.0)))
    assert fit.fitted.solution.problem.records[0].held == held


def test_a_command_on_time_is_not_said_to_act_early_or_late():
    found = estimate(smooth_flight(0.0, False), Aircraft(elevator=Elevator(lag_s=0.0)))
    assert not any("acts" in note for note in found.notes)


def test_a_late_command_does_not_pass_for_the_lag_of_an_unknown_servo():
    found = estimate(smooth_flight(0.006, False), Aircraft())
    lag = found.instrument("servo_lag_s")
    assert lag.value < 1.96 * lag.std
    delay = found.instrument("command_delay_s")
    assert abs(delay.value + 0.006) < 3.0 * delay.std


def test_the_interval_of_every_derivative_contains_the_delay_s_own_error():
    flight = smooth_flight(0.0, False)
    found = estimate(flight, Aircraft(elevator=Elevator(lag_s=0.0)))
    known = solve(prepare([flight], Aircraft(elevator=Elevator(lag_s=0.0))).problem)
    plain = np.sqrt(np.diag(known.covariance_cr))
    assert found.std_cr[6] > 1.2 * plain[6]
