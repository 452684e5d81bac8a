"""An effect put into a flight that ArduPlane recorded is found there: real rates, filters and stamps."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.analysis.gap_flights import maneuvers_of
from advisor.flight.instruments.kinematics import check_alpha, combine
from tests.gap.diagnosed import diagnose

LOGS = Path(__file__).parents[2] / "logs"
LOG = LOGS / "arduplane-calm.tlog"
SERVO = Elevator(calibration=((1000.0, 25.0), (1500.0, 0.0), (2000.0, -25.0)), lag_s=0.14)


@cache
def flown():
    return maneuvers_of([LOG], Aircraft(elevator=SERVO)).maneuvers


def diagnosed(channel, change):
    """Return the diagnosis of the flight with one of its channels changed."""
    maneuvers = [replace(m, channels={**m.channels, channel: change(m.channels[channel])}) for m in flown()]
    return diagnose(maneuvers, Aircraft(elevator=SERVO))


def scaled(by):
    return lambda c: replace(c, y=by * c.y)


def shifted(by):
    return lambda c: replace(c, y=c.y + by)


def later(by):
    return lambda c: replace(c, t=c.t + by)


@pytest.mark.study
@pytest.mark.parametrize(
    ("channel", "change", "effect", "parameter", "size"),
    [
        pytest.param("elevator", later(-0.06), "transport_delay", "delay_s", 0.06, marks=pytest.mark.study),
        pytest.param("q", scaled(0.85), "pitch_rate_scale", "scale", -0.15, marks=pytest.mark.study),
        ("q", shifted(np.radians(1.2)), "pitch_rate_bias", "bias_rad_s", np.radians(1.2)),
        pytest.param("a_z", later(0.08), "accelerometer_skew", "skew_s", 0.08, marks=pytest.mark.study),
    ],
)
def test_an_effect_put_into_a_recorded_flight_is_named_with_its_size(
    channel, change, effect, parameter, size
):
    found = diagnosed(channel, change)
    assert found.verdict == "effect"
    assert found.causes[0].effect == effect
    assert found.causes[0].parameters[parameter].value == pytest.approx(size, rel=0.15)


@pytest.mark.study
def test_as_it_was_flown_the_late_estimate_of_the_angle_of_attack_is_its_nature_and_nothing_is_named():
    found = diagnose(list(flown()), Aircraft(elevator=SERVO))
    assert found.kinematics.finding == "late"
    assert not any(c.present for c in found.causes)


@pytest.mark.study
def test_more_lateness_of_that_estimate_is_measured_by_the_motion_and_is_still_no_fault_of_a_vane():
    """An estimate may be held for 100 ms and filtered for 90 ms: 80 ms more are within its nature."""
    measured = combine([check_alpha(m, None) for m in flown()])
    found = diagnosed("alpha", later(0.08))
    assert found.kinematics.lag_s - measured.lag_s == pytest.approx(0.08, abs=0.01)
    assert found.verdict == "none"
    assert not any(c.present for c in found.causes)


@pytest.mark.study
def test_the_servos_lag_is_found_when_the_file_does_not_have_it():
    unknown = replace(SERVO, lag_s=None)
    found = diagnose(list(flown()), Aircraft(elevator=unknown))
    assert found.causes[0].effect == "actuator_lag"
    lag = found.causes[0].parameters["lag_s"]
    assert abs(lag.value - SERVO.lag_s) < 3.0 * lag.std
    assert lag.std < 0.02


@pytest.mark.study
@pytest.mark.parametrize(
    "name",
    [
        "arduplane-calm.tlog",
        pytest.param(
            "arduplane-turbulent.tlog",
            marks=pytest.mark.xfail(
                raises=AssertionError,
                strict=True,
                reason="The plain model takes the missing lag for damping of the wrong sign in this air.",
            ),
        ),
    ],
)
def test_the_lag_that_a_servo_has_comes_first_where_the_file_lacks_it_whatever_the_air(name):
    """In turbulence of half a metre a second, to which the autopilot's angle of attack is blind, too."""
    servo = replace(SERVO, lag_s=None)
    found = diagnose(
        maneuvers_of([LOGS / name], Aircraft(elevator=servo)).maneuvers, Aircraft(elevator=servo)
    )
    assert found.verdict == "effect"
    assert found.causes[0].effect == "actuator_lag"
    assert found.causes[0].parameters["lag_s"].value == pytest.approx(SERVO.lag_s, abs=0.025)
    assert any(c.effect == "turbulence" for c in found.causes if c.present) == ("turbulent" in name)
