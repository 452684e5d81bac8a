"""The preparation of a manoeuvre's channels before a fit."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.oem.prepare import Prepared, prepare
from tests.oem.builders import maneuver

GRAVITY = 9.80665
SPEED = 24.0


def flown(change, *, accelerometers):
    """Ten seconds in which the air speed swings by this share of its mean, peak to peak."""
    t = np.arange(0.0, 10.0, 0.02)
    alpha, theta = 0.05 + 0.02 * np.sin(3.0 * t), 0.05 + 0.15 * np.sin(0.9 * t)
    speed = SPEED * (1.0 + change / 2.0 * np.sin(1.3 * t))
    rate = SPEED * change / 2.0 * 1.3 * np.cos(1.3 * t)
    a_z = -9.5 + 2.0 * np.sin(3.0 * t)
    channels = {"alpha": alpha, "q": 0.06 * np.cos(3.0 * t), "theta": theta, "airspeed": speed}
    if accelerometers:
        a_x = (rate - a_z * np.sin(alpha) + GRAVITY * np.sin(theta - alpha)) / np.cos(alpha)
        channels |= {"a_x": a_x, "a_z": a_z}
    u = np.where((t > 2.0) & (t < 3.0), 0.05, 0.0)
    return maneuver(1, (t, u), {name: (t, y) for name, y in channels.items()})


def scaled(change, *, accelerometers):
    prepared = prepare([flown(change, accelerometers=accelerometers)], Aircraft())
    assert isinstance(prepared, Prepared)
    return prepared.problem.reference_airspeed_m_s is not None


@pytest.mark.parametrize("accelerometers", [False, True])
def test_derivatives_are_scaled_with_an_air_speed_that_moves_by_more_than_three_percent(accelerometers):
    assert scaled(0.036, accelerometers=accelerometers)


def test_from_one_percent_on_they_are_when_the_speed_s_shape_comes_from_the_accelerometers():
    between = 0.02
    assert scaled(between, accelerometers=True)
    assert not scaled(between, accelerometers=False)


@pytest.mark.parametrize("accelerometers", [False, True])
def test_a_steady_air_speed_scales_nothing(accelerometers):
    assert not scaled(0.007, accelerometers=accelerometers)


def test_the_speed_that_derivatives_are_given_at_is_the_crew_s_or_the_mean():
    flight = flown(0.05, accelerometers=True)
    mean = prepare([flight], Aircraft()).problem.reference_airspeed_m_s
    assert mean == pytest.approx(SPEED, rel=0.01)
    assert prepare([flight], Aircraft(reference_airspeed_m_s=30.0)).problem.reference_airspeed_m_s == 30.0


def test_a_steady_speed_away_from_the_crew_s_reference_is_scaled_to_it():
    away = Aircraft(reference_airspeed_m_s=SPEED * 1.01)
    flight = flown(0.0, accelerometers=True)
    assert prepare([flight], away).problem.reference_airspeed_m_s == away.reference_airspeed_m_s
    near = Aircraft(reference_airspeed_m_s=SPEED * 1.0025)
    assert prepare([flight], near).problem.reference_airspeed_m_s is None
