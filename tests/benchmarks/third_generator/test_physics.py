"""The third generator's flights against answers that are known without it."""

import numpy as np
import pytest

from benchmarks.third_generator.air import dryden
from benchmarks.third_generator.fleet import FLEET, GRAVITY_M_S2, Aircraft
from benchmarks.third_generator.flight import STEP_S, Channels, Gains, Inputs, fly
from benchmarks.third_generator.maneuvers import input_shape, peak_alpha
from benchmarks.third_generator.motion import Around, Faults
from benchmarks.third_generator.servo import Servo
from benchmarks.third_generator.trim import derivatives, jacobian, short_period, trim, with_elevator_near

NO_HANDS = Gains(0.0, 0.0, 0.0, 0.0, 0.0)
every_aircraft = pytest.mark.parametrize("aircraft", FLEET, ids=lambda aircraft: aircraft.name)


def hands_off(shape, level, stick, servo=Servo(), faults=Faults()) -> Channels:  # noqa: B008
    one = np.ones(stick.size)
    given = Inputs(
        stick=stick,
        hands_off=one,
        speed=one * level.speed,
        height=one * level.height,
        alpha=one * level.alpha,
        delta=one * level.delta,
        throttle=one * level.throttle,
        throttle_step=0.0 * one,
        remnant=0.0 * one,
        around=tuple(value * one for value in Around()),
    )
    _, channels = fly(level.state, given, shape, faults, servo, NO_HANDS, (1e9, -1e9), 1.0)
    return channels


def level_flight(aircraft: Aircraft):
    shape = with_elevator_near(aircraft, -0.02)
    return shape, trim(shape, Faults(), Around(), aircraft.airspeed_m_s, aircraft.height_m)


def a_test_input(own_rad_s: float, model: dict[str, float], alpha_rad: float):
    series = input_shape("3-2-1-1", own_rad_s, np.random.default_rng(2))
    series = np.concatenate([np.zeros(100), series, np.zeros(int(4.0 / own_rad_s / STEP_S))])
    return series * alpha_rad / peak_alpha(series, model)


@every_aircraft
def test_a_trimmed_aircraft_flies_on_at_its_height_and_speed(aircraft):
    shape, level = level_flight(aircraft)
    flown = hands_off(shape, level, np.zeros(2000))
    assert np.ptp(flown["airspeed"]) < 1e-4
    assert np.ptp(flown["height"]) < 1e-3


@every_aircraft
def test_lift_carries_the_weight_in_level_flight(aircraft):
    shape, level = level_flight(aircraft)
    flown = hands_off(shape, level, np.zeros(10))
    up = -flown["a_z"][0] * np.cos(level.alpha) + flown["a_x"][0] * np.sin(level.alpha)
    assert up == pytest.approx(GRAVITY_M_S2, abs=1e-5)


@every_aircraft
def test_energy_stays_without_drag_and_thrust(aircraft):
    shape, level = level_flight(aircraft)
    shape = shape._replace(drag_0=0.0, induced=0.0, thrust_0=0.0)
    own, _ = short_period(derivatives(shape, level))
    stick = a_test_input(own, derivatives(shape, level), 0.03)
    flown = hands_off(shape, level, stick)
    energy = 0.5 * flown["airspeed"] ** 2 + GRAVITY_M_S2 * flown["height"]
    kinetic = np.ptp(0.5 * flown["airspeed"] ** 2)
    assert np.ptp(energy) < 1e-4 * kinetic


@every_aircraft
def test_the_files_derivatives_are_those_of_a_flight_by_least_squares(aircraft):
    shape, level = level_flight(aircraft)
    model = derivatives(shape, level)
    own, _ = short_period(model)
    flown = hands_off(shape, level, a_test_input(own, model, 0.005))
    ratio = flown["airspeed"] / level.speed
    columns = np.column_stack(
        [ratio**2 * flown["alpha"], ratio * flown["q"], ratio**2 * flown["surface"], ratio**2]
    )
    found = np.linalg.lstsq(columns, flown["q_dot"], rcond=None)[0]
    for value, name in zip(found, ("M_alpha", "M_q", "M_delta_e"), strict=False):
        assert value == pytest.approx(model[name], rel=0.02)
    lift = flown["a_z"] * np.cos(flown["alpha"]) - flown["a_x"] * np.sin(flown["alpha"])
    columns = np.column_stack([ratio * flown["alpha"], ratio * flown["surface"], ratio])
    force = np.linalg.lstsq(columns, lift / flown["airspeed"] - model["Z_q"] * flown["q"], rcond=None)[0]
    assert force[0] == pytest.approx(model["Z_alpha"], rel=0.01)
    assert force[1] == pytest.approx(model["Z_delta_e"], rel=0.1)


@every_aircraft
def test_folding_the_downwash_in_keeps_the_roots_of_the_short_period(aircraft):
    shape, level = level_flight(aircraft)
    model = derivatives(shape, level)
    reduced = np.array([[model["Z_alpha"], 1.0 + model["Z_q"]], [model["M_alpha"], model["M_q"]]])
    full = np.linalg.eigvals(jacobian(shape, level)[0])
    slow = full[np.argsort(np.abs(full))[:2]]
    np.testing.assert_allclose(np.sort_complex(np.linalg.eigvals(reduced)), np.sort_complex(slow), rtol=1e-8)


def test_moving_the_centre_of_gravity_to_the_neutral_point_takes_the_stiffness():
    # At the neutral point a small change of angle of attack leaves the trimmed moment as it is.
    shape, level = level_flight(FLEET[4])
    lift = -derivatives(shape, level)["Z_alpha"]
    stiffness = -derivatives(shape, level)["M_alpha"] * shape.inertia / (shape.mass * lift * level.speed)
    nearer = shape._replace(strip_x=shape.strip_x - stiffness, tail_x=shape.tail_x - stiffness)
    there = trim(nearer, Faults(), Around(), level.speed, level.height)
    assert abs(derivatives(nearer, there)["M_alpha"]) < 0.12 * abs(derivatives(shape, level)["M_alpha"])


def test_a_servo_answers_a_step_as_a_first_order_lag_after_its_delay():
    shape, level = level_flight(FLEET[5])
    stick = np.where(np.arange(400) >= 100, 0.01, 0.0)
    flown = hands_off(shape, level, stick, Servo(lag_s=0.05, delay_s=0.02))
    since = STEP_S * (np.arange(400) - 99.5) - 0.02
    expected = level.delta + 0.01 * np.where(since > 0.0, 1.0 - np.exp(-since / 0.05), 0.0)
    assert np.max(np.abs(flown["surface"] - expected)) < 5e-4


def test_play_leaves_the_surface_behind_by_its_half_width():
    shape, level = level_flight(FLEET[5])
    stick = np.interp(np.arange(300), [100, 200], [0.0, 0.02])
    flown = hands_off(shape, level, stick, Servo(play=0.004))
    assert flown["command"][-1] - flown["surface"][-1] == pytest.approx(0.004, abs=1e-9)


def test_turbulence_has_the_strength_that_is_asked_for():
    wind = dryden(2_000_000, 1.3, 100.0, 50.0, np.random.default_rng(5))
    assert np.std(wind) == pytest.approx(1.3, rel=0.05)
