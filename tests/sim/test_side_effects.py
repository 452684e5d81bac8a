"""Effects of roll and yaw in the bundled aircraft."""

import math

import pytest

from sim.effects.side import SIDE, side_kit
from sim.lateral import FULL_RAD, UAV, LateralAircraft
from sim.linear import RESEARCH_JET
from sim.loading import ScenarioError
from sim.motion import Controls
from sim.sensors import ideal


def aircraft(**effects):
    return LateralAircraft(RESEARCH_JET, 25.0, 150.0, UAV, side_kit(3, effects))


def rolled(flown, aileron, *, seconds=0.2, throttle=0.0, dt=0.002):
    level = flown.trim
    for _ in range(round(seconds / dt)):
        motion = flown.step(Controls(level.elevator, level.throttle + throttle, aileron), dt)
    return motion


def test_a_dead_band_takes_its_half_width_from_the_aileron():
    dead = aircraft(aileron_actuator_deadband={"half_width_rad": 0.5 * 0.2 * FULL_RAD})
    assert rolled(dead, 0.2).p == pytest.approx(rolled(aircraft(), 0.1).p)


def test_a_slow_aileron_rolls_less_in_equal_time():
    slow = aircraft(aileron_actuator_rate_limit={"rate_rad_s": 0.2})
    assert 0.0 < rolled(slow, 0.2).p < 0.5 * rolled(aircraft(), 0.2).p


def test_a_rudders_servo_leaves_the_aileron_alone():
    lagging = aircraft(rudder_actuator_lag={"lag_s": 0.1})
    assert rolled(lagging, 0.2) == rolled(aircraft(), 0.2)


def test_more_throttle_rolls_by_the_propeller_as_the_aileron_would():
    turning = aircraft(propeller_roll={"aileron_rad": 0.2 * FULL_RAD})
    assert rolled(turning, 0.0, throttle=0.5).p == pytest.approx(rolled(aircraft(), -0.1).p)


def test_an_accelerometer_ahead_feels_the_change_of_the_yaw_rate():
    kit = side_kit(3, {"accelerometer_offset": {"arm_m": 0.4}})
    (sensor,) = kit.fittings.sensors
    motion = aircraft().motion()
    sensor.apply(motion._replace(r=0.0), ideal(motion._replace(r=0.0)), 0.0)
    turned = motion._replace(r=0.01)
    reading = ideal(turned)
    sensor.apply(turned, reading, 0.002)
    assert reading.a_y == pytest.approx(0.4 * 0.01 / 0.002)


def test_air_that_moves_sideways_rolls_the_aircraft():
    assert rolled(aircraft(), 0.0).p == 0.0
    assert not math.isclose(rolled(aircraft(side_turbulence={"sigma_v_m_s": 1.0}), 0.0).p, 0.0, abs_tol=1e-4)


def test_an_unknown_effect_or_size_names_the_known_ones():
    with pytest.raises(ScenarioError, match="aileron_actuator_lag"):
        side_kit(3, {"elevator_lag": {}})
    with pytest.raises(ScenarioError, match="half_width_rad"):
        side_kit(3, {"aileron_actuator_backlash": {"width": 0.1}})
    assert all(side_kit(3, {name: {}}) for name in SIDE)
