"""Messages that repeat old values under new stamps are named, and data are blamed before the file."""

from advisor.doctor.examination import Limit, in_order
from advisor.doctor.limits import repeat_limits
from advisor.doctor.survey import Arrival


def arrival(name: str, rate_hz: float, renewed_hz: float) -> Arrival:
    return Arrival(name, 1000, rate_hz, 0.1, 0.02, renewed_hz, rate_hz)


def test_a_stream_sent_twice_is_named_with_the_rate_that_counts() -> None:
    (limit,) = repeat_limits([arrival("ATTITUDE", 100.0, 50.0)])
    assert "its values change at 50 Hz only" in limit.text
    assert not limit.stops


def test_a_sound_stream_is_no_defect() -> None:
    assert repeat_limits([arrival("ATTITUDE", 50.0, 49.5), arrival("RAW_IMU", 50.0, float("nan"))]) == []


def test_defects_of_the_data_are_said_before_numbers_of_the_file() -> None:
    limits = [
        Limit("calibration", "not calibrated", "calibrate"),
        Limit("repeats", "repeats", "send once"),
        Limit("servo_limits", "assumed", "record them"),
        Limit("no_elevator", "no elevator", "give it", stops=True),
        Limit("clock_drift", "drifts", "compare"),
    ]
    said = [limit.code for limit in in_order(limits)]
    assert said == ["no_elevator", "repeats", "clock_drift", "calibration", "servo_limits"]
