"""The servo of an improved simulator: that of the aircraft file, and what was found beyond it."""

import pytest

from advisor.aircraft.controls import Elevator
from advisor.exports.models.improvement import ExportedServo, servo_of

FOUND = {"transport_delay": {"delay_s": 0.03}, "actuator_lag": {"lag_s": 0.08}}


def test_delay_and_lag_of_the_file_and_of_the_flight_add_up():
    servo = servo_of(Elevator(delay_s=0.02, lag_s=0.05), FOUND)
    assert (servo.delay_s, servo.lag_s) == pytest.approx((0.05, 0.13))


def test_a_file_without_a_servo_leaves_what_was_found():
    servo = servo_of(Elevator(), FOUND)
    assert (servo.delay_s, servo.lag_s) == pytest.approx((0.03, 0.08))
    assert servo_of(Elevator(), {}) == ExportedServo()
