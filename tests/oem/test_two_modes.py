"""A second peak of the posterior widens the joint errors by its probability."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem import instrument_fit
from advisor.oem.estimator import fit_jointly
from advisor.oem.instruments import SERVO_LAG
from tests.oem.test_instruments import SPEED, equipped

OFF = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 30.0, 2.0, 40.0])


@pytest.fixture(scope="module")
def joint():
    """Return the fit of two manoeuvres with an open lag of 0.1 s."""
    flights = [equipped(number=i, sign=(-1.0) ** i, lag_s=0.1, noise=0.02, seed=i) for i in range(2)]
    return fit_jointly(flights, Aircraft(airspeed_m_s=SPEED)).fitted


def with_rival(joint, cost, monkeypatch):
    """Return the solution where a second search ends ``OFF`` away, at a cost higher by ``cost``."""
    best = replace(joint.solution, modes=None)
    optimum = best.optimum._replace(log_likelihood_cost=best.optimum.log_likelihood_cost + cost)
    rival = replace(
        best, theta=best.theta + OFF, optimum=optimum, problem=SERVO_LAG.write(best.problem, 0.04)
    )
    place = rival.theta, np.zeros(0)
    searched = SimpleNamespace(cost=optimum.log_likelihood_cost, problem=rival.problem, place=place)
    monkeypatch.setattr(instrument_fit, "_searched", lambda *_: searched)
    monkeypatch.setattr(instrument_fit, "_evaluated", lambda *_: rival)
    monkeypatch.setattr(instrument_fit, "reported", lambda *_: rival.theta)
    names = [x.instrument for x in joint.identified]
    share = instrument_fit.colour_share(best)
    return best, rival, instrument_fit._between_modes(best, names, SERVO_LAG, share)


def test_a_peak_as_high_as_the_best_adds_half_of_the_squared_distance(joint, monkeypatch):
    best, _, found = with_rival(joint, 0.0, monkeypatch)
    assert found.theta is best.theta
    np.testing.assert_allclose(found.modes[:8, :8], 0.5 * np.outer(OFF, OFF))
    added = np.diag(found.widened)[:8] - np.diag(best.widened)[:8]
    np.testing.assert_allclose(added, 0.5 * OFF**2, rtol=1e-9, atol=1e-9)


def test_a_peak_far_below_the_best_adds_nothing(joint, monkeypatch):
    _, _, found = with_rival(joint, 1e4, monkeypatch)
    assert np.max(np.abs(found.modes)) < 1e-12


def test_the_higher_peak_is_the_estimate(joint, monkeypatch):
    _, rival, found = with_rival(joint, -1e4, monkeypatch)
    assert found.theta is rival.theta


def test_coloured_noise_brings_a_lower_peak_nearer(joint, monkeypatch):
    monkeypatch.setattr(instrument_fit, "colour_share", lambda _: 0.1)
    _, _, found = with_rival(joint, 200.0, monkeypatch)
    np.testing.assert_allclose(found.modes[:8, :8], np.outer(OFF, OFF) / (1.0 + np.e), rtol=1e-9)


def test_one_manoeuvre_looks_for_no_second_peak(monkeypatch):
    alone = fit_jointly([equipped(lag_s=0.1, noise=0.02)], Aircraft(airspeed_m_s=SPEED)).fitted
    best, _, found = with_rival(alone, 0.0, monkeypatch)
    assert found is best
