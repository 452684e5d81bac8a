"""Instruments that manoeuvres tell together, and the errors that they cause in each manoeuvre's estimate."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem import evaluation
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.extra import Prior
from advisor.oem.known_instruments import FoundInstruments, found_of, with_found
from tests.oem.test_instruments import SPEED, equipped

OPEN = Aircraft(airspeed_m_s=SPEED)


@pytest.fixture(scope="module")
def flights():
    return [equipped(number=i, sign=(-1.0) ** i, lag_s=0.1, noise=0.02, seed=i) for i in range(3)]


@pytest.fixture(scope="module")
def joint(flights):
    return estimate_jointly(flights, OPEN)


def test_what_the_model_lacks_on_the_way_to_a_lag_takes_no_lag_away(flights, monkeypatch):
    monkeypatch.setattr(evaluation, "model_error", lambda *given: np.eye(given[-1].shape[1]))
    assert "servo_lag_s" in estimate_jointly(flights, OPEN).found.names


def test_a_joint_estimate_tells_all_its_instruments_and_the_errors_that_they_cause(joint):
    assert {"servo_lag_s", "command_delay_s"} <= set(joint.found.names)
    assert joint.found.value("servo_lag_s") == joint.instrument("servo_lag_s").value
    caused = np.diag(joint.found.covariance)
    assert np.all(caused >= 0.0)
    assert np.all(caused <= np.diag(joint.covariance) * (1.0 + 1e-9))


def test_a_manoeuvre_takes_the_instruments_that_all_have_told(flights, joint):
    told = estimate(flights[0], with_found(OPEN, joint.found))
    assert told.servo_lag_s == joint.found.value("servo_lag_s")
    lag = told.instrument("servo_lag_s")
    assert (lag.value, lag.std) == (told.servo_lag_s, joint.instrument("servo_lag_s").std)
    np.testing.assert_allclose(told.covariance, told.own_covariance + joint.found.covariance)


def test_another_power_on_estimates_its_own_delay_of_the_command(flights, joint):
    known = with_found(OPEN, joint.found.without("command_delay_s"))
    told = estimate(flights[0], known)
    assert told.instrument("command_delay_s") is not None
    assert told.found.names == ("command_delay_s",)


def test_what_the_instruments_cause_grows_with_the_speed_as_the_derivatives_do():
    found = FoundInstruments((), np.empty(0), np.empty(0), np.eye(8), 20.0)
    faster = np.diag(found.covariance_at(40.0))
    np.testing.assert_allclose(faster, [4.0, 4.0, 1.0, 4.0, 16.0, 16.0, 4.0, 16.0])
    np.testing.assert_array_equal(found.covariance_at(None), np.eye(8))


def test_the_crew_s_own_aircraft_tells_no_instruments():
    assert found_of(OPEN) is None
    told = with_found(OPEN, FoundInstruments(("servo_lag_s",), np.ones(1), np.ones(1), np.eye(8), None))
    assert replace(told, found=None) == with_found(OPEN, None)


def of_one_lag(prior: Prior | None) -> FoundInstruments:
    """Instruments with a servo's lag alone, known to 10 ms, on which Z_0 depends with slope 1."""
    covariance = np.zeros((9, 9))
    covariance[8, 8] = covariance[0, 8] = covariance[8, 0] = 1e-4
    return FoundInstruments.of([("servo_lag_s", 0.1, prior)], covariance, None)


def test_what_data_know_of_a_lag_narrows_as_data_come():
    assert of_one_lag(None).stays(4.0)[0] == pytest.approx(0.25)


def test_what_only_a_prior_knows_of_a_lag_stays():
    assert of_one_lag(Prior(0.1, 0.01)).stays(4.0)[0] == pytest.approx(1.0)


def test_half_of_the_information_from_a_prior_halves_what_data_add():
    assert of_one_lag(Prior(0.1, 0.01 * 2.0**0.5)).stays(3.0)[0] == pytest.approx(0.5)
