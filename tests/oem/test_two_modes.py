"""A second peak of the posterior widens the joint errors by its probability."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Accelerometer, Aircraft, Alpha
from advisor.model.outputs import SHARED
from advisor.oem import instrument_fit
from advisor.oem.estimator import fit_jointly
from advisor.oem.instruments import SERVO_LAG
from advisor.oem.prior import usual_moments
from advisor.oem.profile import Posterior
from tests.oem.test_instruments import SPEED, equipped

OFF = np.array([1.0, 0.0, 0.0, 30.0, 2.0, 40.0, 0.0])
"""Distance of the second peak, in the order of ``SHARED``."""
AWAY = np.array([0.0, 1.0, 0.0, 0.0, 0.0, 30.0, 2.0, 40.0])
"""Distance of the second peak, in the order of the eight parameters."""
OVERDAMPED = np.array([0.092, -3.976, -0.032, -0.276, 0.3, -3.995, -7.953, -42.643])


@pytest.fixture(scope="module")
def joint():
    """Return the fit of two manoeuvres with an open lag of 0.1 s."""
    flights = [equipped(number=i, sign=(-1.0) ** i, lag_s=0.1, noise=0.02, seed=i) for i in range(2)]
    return fit_jointly(flights, Aircraft(airspeed_m_s=SPEED)).fitted


def with_rival(joint, cost, monkeypatch, share=1.0):
    """Return the solution where a second search ends ``OFF`` away, at a cost higher by ``cost``."""
    best = replace(joint.solution, modes=None)
    optimum = best.optimum._replace(
        log_likelihood_cost=best.optimum.log_likelihood_cost + cost, shared=best.optimum.shared + OFF
    )
    rival = replace(best, optimum=optimum, problem=SERVO_LAG.write(best.problem, 0.04))
    searched = SimpleNamespace(
        cost=optimum.log_likelihood_cost, problem=rival.problem, assembly=best.assembly, optimum=optimum
    )
    monkeypatch.setattr(instrument_fit, "_searched", lambda *_: searched)
    monkeypatch.setattr(instrument_fit, "_evaluated", lambda *_: rival)
    names = [x.instrument for x in joint.identified]
    found = instrument_fit._of_two_hills(best, [best], Posterior(names, share))
    return best, rival, found


def test_a_peak_as_high_as_the_best_adds_half_of_the_squared_distance(joint, monkeypatch):
    best, _, found = with_rival(joint, 0.0, monkeypatch)
    assert found.optimum is best.optimum
    np.testing.assert_allclose(found.modes[:8, :8], 0.5 * np.outer(AWAY, AWAY), atol=1e-9)
    added = np.diag(found.widened)[:8] - np.diag(best.widened)[:8]
    np.testing.assert_allclose(added, 0.5 * AWAY**2, rtol=1e-9, atol=1e-9)


def test_a_peak_far_below_the_best_adds_nothing(joint, monkeypatch):
    _, _, found = with_rival(joint, 1e4, monkeypatch)
    assert np.max(np.abs(found.modes)) < 1e-12


@pytest.mark.parametrize(("cost", "said"), [(3.0, True), (-3.0, True), (5.0, False)])
def test_a_peak_within_two_nats_is_said(joint, monkeypatch, cost, said):
    best, rival, found = with_rival(joint, cost, monkeypatch)
    assert (found.alike is not None) is said
    if said:
        lag_s = [SERVO_LAG.read(at.problem) for at in (best, rival)]
        np.testing.assert_allclose(found.alike[:, 0], lag_s if cost > 0.0 else lag_s[::-1])
        np.testing.assert_allclose(np.abs(found.alike[1, 1:9] - found.alike[0, 1:9]), AWAY, atol=1e-9)


def test_the_higher_peak_is_the_estimate(joint, monkeypatch):
    _, rival, found = with_rival(joint, -1e4, monkeypatch)
    assert found.optimum is rival.optimum


def test_coloured_noise_brings_a_lower_peak_nearer(joint, monkeypatch):
    _, _, found = with_rival(joint, 200.0, monkeypatch, share=0.1)
    np.testing.assert_allclose(found.modes[:8, :8], np.outer(AWAY, AWAY) / (1.0 + np.e), rtol=1e-6, atol=1e-9)


def test_an_unusual_damping_makes_a_peak_less_likely(joint):
    """The rival's C_mq is 20 times the usual one, at which both usual peaks would be equally likely."""
    best = joint.solution
    problem = replace(best.problem, per_coefficient={"M_q": abs(best.theta[6]) / 20.0})
    shared = best.optimum.shared.copy()
    shared[SHARED.index("M_q")] *= 20.0
    rival = replace(best, problem=problem, optimum=best.optimum._replace(shared=shared))
    nats, _ = Posterior((), 1.0, usual_moments).apart(replace(best, problem=problem), rival)
    np.testing.assert_allclose(nats, 0.5 * (20.0**2 - 1.0))


def test_the_pole_of_an_overdamped_aircraft_is_not_the_servos():
    """A filter of 20 Hz, as a delay, looks like the aircraft's pole where the servo has the aircraft's."""
    flights = [
        equipped(number=i, sign=(-1.0) ** i, delay_s=0.017, noise=0.005, seed=i, of=OVERDAMPED)
        for i in range(2)
    ]
    found = fit_jointly(flights, Aircraft(airspeed_m_s=SPEED)).estimate()
    assert abs(found.theta[6] - OVERDAMPED[6]) < 1.0


def test_another_hill_keeps_a_statement_that_the_data_confirm(monkeypatch):
    """A stated place of the vane is the same on every hill."""
    starts = []
    inside = instrument_fit._of_two_hills

    def seen(best, others, posterior):
        starts.extend(others)
        return inside(best, others, posterior)

    monkeypatch.setattr(instrument_fit, "_of_two_hills", seen)
    flights = [
        equipped(number=i, sign=(-1.0) ** i, delay_s=0.017, noise=0.02, seed=i, of=OVERDAMPED)
        for i in range(2)
    ]
    stated = Aircraft(airspeed_m_s=SPEED, alpha=Alpha(vane_arm_m=0.0), accelerometer=Accelerometer(arm_m=0.0))
    fit_jointly(flights, stated)
    assert [at.problem.vane_arm_m for at in starts][-1] == 0.0
