"""What the fit tells of instruments, as findings for every face of the program."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.oem.estimate import InstrumentEstimate
from advisor.oem.notes import findings_of
from tests.decision.campaigns import estimate


def only(told, aircraft=None):
    described = aircraft or Aircraft()
    return next(f for f in findings_of(replace(estimate(), instruments=(told,)), described))


def test_an_excluded_lag_is_said_with_its_size_and_the_line_for_the_file():
    told = InstrumentEstimate("servo_lag_s", 0.22, 0.004, 0.14, 0.22, 0.004, contradicts=True)
    found = only(told, Aircraft(elevator=Elevator(lag_s=0.14)))
    assert (found.code, found.stated, found.value) == ("elevator_lag_s", 0.14, 0.22)
    assert found.text == "the surface responds 0.08 s later than elevator.lag_s says"
    assert found.fix == "elevator: {lag_s: 0.220}"
    assert found.contradicts
    assert not found.refuses


def test_a_confirmed_lag_is_said_with_what_the_data_tell_alone_and_needs_no_line():
    told = InstrumentEstimate("servo_lag_s", 0.1395, 0.003, 0.14, 0.136, 0.005)
    found = only(told, Aircraft(elevator=Elevator(lag_s=0.14)))
    assert found.value == 0.136
    assert "as elevator.lag_s says" in found.text
    assert not found.contradicts
    assert not found.fix


def test_a_lag_that_nobody_states_comes_with_the_line_for_the_file():
    found = only(InstrumentEstimate("servo_lag_s", 0.1, 0.004))
    assert found.stated is None
    assert found.used
    assert found.fix == "elevator: {lag_s: 0.100}"


def test_a_late_command_is_held_against_the_stated_delay():
    told = InstrumentEstimate(
        "command_delay_s", 0.3, 0.001, unstated_value=0.3, unstated_std=0.001, contradicts=True
    )
    found = only(told, Aircraft(elevator=Elevator(delay_s=0.05)))
    assert found.text == "the command acts 0.250 s later than elevator.delay_s says"
    assert found.fix == "elevator: {delay_s: 0.300}"
    assert not found.refuses


@pytest.mark.parametrize(
    ("name", "code"),
    [("vane_arm_m", "alpha_arm_m"), ("alpha_delay_s", "alpha_delay_s"), ("accelerometer_arm_m", "a_z_arm_m")],
)
def test_every_instrument_of_the_fit_has_a_finding(name, code):
    found = only(InstrumentEstimate(name, 0.05, 0.01))
    assert found.code == code
    assert found.text


def test_an_elevator_that_turns_the_nose_the_wrong_way_refuses_every_estimate():
    good = estimate()
    theta, covariance = np.array(good.theta), np.array(good.covariance)
    theta[7], covariance[7, 7] = 11.8, 0.2**2
    turned = replace(good, theta=theta, covariance=covariance)
    found = next(f for f in findings_of(turned, Aircraft()) if f.quantity == "sign")
    assert found.refuses
    assert "+11.8" in found.text
    covariance[7, 7] = 5.0**2
    unsure = replace(good, theta=theta, covariance=covariance)
    assert not any(f.quantity == "sign" for f in findings_of(unsure, Aircraft()))
    assert not any(f.quantity == "sign" for f in findings_of(good, Aircraft()))
