"""The effect of a log's instruments on the estimate, and its correction by the estimator."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Accelerometer, Aircraft, Alpha, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.flight.signals.record import Channel
from advisor.model.axes.lateral import LATERAL
from advisor.oem.airspeed import airspeed
from advisor.oem.axis.parameter import parameters_of
from advisor.oem.axis.problem import AxisProblem
from advisor.oem.estimate import Estimate, NoEstimate
from advisor.oem.estimator import estimate, estimate_jointly
from advisor.oem.extra import Prior
from advisor.oem.instrument_fit import _identified
from advisor.oem.instruments import COMMAND_DELAY, SERVO_LAG, unknown_instruments
from advisor.oem.prepare import prepare
from advisor.oem.problem import OutputErrorProblem, Record
from advisor.oem.rows import Signal
from advisor.oem.surface import Servo
from tests.oem.axis.builders import JET, aileron_doublet
from tests.oem.axis.builders import flown as flown_sideways
from tests.oem.builders import UAV, elevator_3211, flown, maneuver, simulate, trim_alpha, trim_elevator

SPEED = 25.0
GRAVITY = 9.80665
RATE = 50.0


def equipped(
    *,
    number=1,
    sign=1.0,
    lag_s=0.0,
    delay_s=0.0,
    vane_m=0.0,
    imu_m=0.0,
    noise=0.0,
    seed=0,
    quantum=0.0,
    bias=0.0,
    of=UAV,
):
    """Return a manoeuvre of an aircraft at constant speed: α from a vane, θ, a_z, servo."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, 9.0, 1.0 / RATE)
    u = elevator_3211(t, trim=trim_elevator(of), amplitude=0.02 * sign, unit_s=0.4)
    fine = np.arange(0.0, 9.0, 0.002)
    command = np.interp(fine - delay_s, t, u)
    surface = command.copy()
    for k in range(1, len(fine)):
        before, now = command[k - 1], command[k]
        if lag_s:
            decay = np.exp(-0.002 / lag_s)
            trailing = lag_s * (now - before) / 0.002
            surface[k] = now - trailing + (surface[k - 1] - before + trailing) * decay
    x = simulate(of, [trim_alpha(of), 0.0], fine, surface, t[1:-1])
    alpha, q, theta = x.T
    theta = theta + 0.05
    delta = np.interp(t[1:-1], fine, surface)
    alpha_dot = of[0] + of[1] * alpha + (1 + of[2]) * q + of[3] * delta
    q_dot = of[4] + of[5] * alpha + of[6] * q + of[7] * delta
    a_z = SPEED * np.cos(alpha) * (alpha_dot - q) - GRAVITY * np.cos(theta) - imu_m * q_dot + bias
    channels = {"alpha": alpha - vane_m / SPEED * q, "q": q, "theta": theta, "a_z": a_z}
    for y in channels.values():
        y += noise * np.std(y) * rng.standard_normal(len(y))
    if quantum:
        channels["a_z"] = np.round(channels["a_z"] / quantum) * quantum
    return maneuver(number, (t, u), {name: (t[1:-1], y) for name, y in channels.items()})


def aircraft(**parts):
    return Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=0.0, delay_s=0.0), **parts)


def test_acceleration_serves_as_an_output_with_arm_and_bias():
    found = estimate(equipped(imu_m=0.3, bias=0.4), aircraft(accelerometer=Accelerometer(arm_m=0.3)))
    assert isinstance(found, Estimate)
    assert set(found.outputs) == {"alpha", "q", "a_z"}
    # γ is constant in Eqs. (1)-(2); that α̇ neglects its cosine is all that is left here.
    np.testing.assert_allclose(found.theta[[1, 5, 6, 7]], UAV[[1, 5, 6, 7]], rtol=0.02)


def test_acceleration_makes_the_lift_derivatives_sharper():
    flight = equipped(noise=0.02)
    with_it = estimate(flight, aircraft())
    without = estimate(
        maneuver(
            1,
            (flight.channels["elevator"].t, flight.channels["elevator"].y),
            {n: (flight.channels[n].t, flight.channels[n].y) for n in ("alpha", "q")},
        ),
        aircraft(),
    )
    assert with_it.std[3] < 0.6 * without.std[3]
    assert any("The fit lacks the vertical acceleration" in note for note in without.notes)


def test_quantised_acceleration_gets_the_weight_it_deserves():
    coarse = estimate(equipped(noise=0.02, quantum=0.5), aircraft())
    assert coarse.fits[0]["a_z"].noise == pytest.approx(0.5 / np.sqrt(12.0), rel=0.3)
    assert np.all(
        np.abs(coarse.theta - UAV)[[1, 5, 6, 7]]
        < 5 * coarse.std[[1, 5, 6, 7]] + 0.02 * np.abs(UAV)[[1, 5, 6, 7]]
    )


def test_a_vane_ahead_of_the_centre_of_gravity_is_moved_back_when_its_arm_is_known():
    flight = equipped(vane_m=0.8)
    flat = {n: (flight.channels[n].t, flight.channels[n].y) for n in ("alpha", "q")}
    plain = maneuver(1, (flight.channels["elevator"].t, flight.channels["elevator"].y), flat)
    moved = estimate(plain, aircraft(alpha=Alpha(vane_arm_m=0.8)))
    np.testing.assert_allclose(moved.theta, UAV, rtol=2e-3, atol=2e-3)
    left = estimate(plain, aircraft())
    # The arm is a similarity transformation: as good a fit, M_alpha and M_delta_e kept, the rest moved.
    assert left.fits[0]["alpha"].r2 > 0.999999
    np.testing.assert_allclose(left.theta[[5, 7]], UAV[[5, 7]], rtol=2e-3)
    assert left.value("Z_delta_e") == pytest.approx(UAV[3] - 0.8 / SPEED * UAV[7], rel=1e-2)


def without_force(flight, provenance):
    """The flight without a specific force, its angle of attack of this provenance."""
    channels = {name: c for name, c in flight.channels.items() if name != "a_z"}
    alpha = replace(channels["alpha"], provenance=provenance)
    return replace(flight, channels={**channels, "alpha": alpha})


def test_without_a_force_the_intervals_hold_a_vane_of_unknown_arm():
    found = estimate(without_force(equipped(vane_m=2.5, noise=0.01), "vane"), aircraft())
    for name in ("Z_alpha", "M_alpha", "M_q", "M_delta_e"):
        true = UAV[PARAMETERS.index(name)]
        assert abs(found.value(name) - true) < 1.96 * found.std[PARAMETERS.index(name)]
    assert any("Give alpha.vane_arm_m" in note for note in found.notes)


def test_without_a_force_a_known_arm_or_a_computed_alpha_keeps_the_intervals_narrow():
    q = PARAMETERS.index("M_q")
    flight = equipped(noise=0.01)
    open_arm = estimate(without_force(flight, "vane"), aircraft()).std[q]
    computed = estimate(without_force(flight, "derived"), aircraft()).std[q]
    stated = estimate(without_force(flight, "vane"), aircraft(alpha=Alpha(vane_arm_m=0.0))).std[q]
    assert computed < 0.5 * open_arm
    assert stated < 0.5 * open_arm


def test_a_known_servo_is_applied_to_the_command_before_the_fit():
    flight = equipped(lag_s=0.1, delay_s=0.04)
    known = Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=0.1, delay_s=0.04))
    found = estimate(flight, known)
    assert found.value("M_delta_e") == pytest.approx(UAV[7], rel=0.03)
    assert not found.instrument("servo_lag_s").contradicts


@pytest.mark.parametrize(("stated_s", "true_s"), [(0.0, 0.1), (0.04, 0.1), (0.14, 0.22), (0.2, 0.1)])
def test_a_stated_lag_that_the_data_exclude_is_named_and_not_used(stated_s, true_s):
    described = Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=stated_s))
    found = estimate(equipped(lag_s=true_s, noise=0.01), described)
    lag = found.instrument("servo_lag_s")
    assert lag.contradicts
    assert lag.stated == stated_s
    assert abs(lag.value - true_s) < 3.0 * lag.std + 0.005
    assert found.value("M_delta_e") == pytest.approx(UAV[7], rel=0.05)


@pytest.mark.parametrize("lag_s", [0.04, 0.1, 0.2])
def test_a_stated_lag_that_the_data_confirm_stays_and_its_width_is_in_the_interval(lag_s):
    flight = equipped(lag_s=lag_s, noise=0.02)
    found = estimate(flight, Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=lag_s)))
    lag = found.instrument("servo_lag_s")
    assert not lag.contradicts
    assert abs(lag.unstated_value - lag_s) < 3.0 * lag.unstated_std
    assert lag.std <= 0.1 * lag_s
    assert abs(found.value("M_delta_e") - UAV[7]) < 3.0 * found.std[7]


def test_an_unknown_servo_lag_is_found_from_all_manoeuvres_together():
    flights = [equipped(number=i, sign=(-1.0) ** i, lag_s=0.1, noise=0.02, seed=i) for i in range(3)]
    found = estimate_jointly(flights, Aircraft(airspeed_m_s=SPEED))
    assert found.value("M_delta_e") == pytest.approx(UAV[7], rel=0.04)
    lag = found.instrument("servo_lag_s")
    assert abs(lag.value - 0.1) < 3.0 * lag.std + 0.005


def test_one_rich_manoeuvre_tells_the_servo_lag_too():
    alone = estimate(equipped(lag_s=0.1, noise=0.02), Aircraft(airspeed_m_s=SPEED))
    lag = alone.instrument("servo_lag_s")
    assert abs(lag.value - 0.1) < 3.0 * lag.std + 0.005
    assert any("The servo's lag is" in note for note in alone.notes)
    assert alone.value("M_delta_e") == pytest.approx(UAV[7], rel=0.1)


def test_a_vane_of_unknown_place_is_found_from_a_z_and_the_pitch_rate():
    flights = [equipped(number=i, sign=(-1.0) ** i, vane_m=2.0, noise=0.02, seed=i) for i in range(2)]
    found = estimate_jointly(flights, aircraft(accelerometer=Accelerometer(arm_m=0.0)))
    arm = found.instrument("vane_arm_m")
    assert abs(arm.value - 2.0) < 3.0 * arm.std
    assert abs(found.value("Z_delta_e") - UAV[3]) < 3.0 * found.std[3] + 0.1


def test_a_vane_whose_place_the_crew_gives_is_not_sought():
    found = estimate(equipped(vane_m=2.0, noise=0.02), aircraft(alpha=Alpha(vane_arm_m=2.0)))
    assert found.instrument("vane_arm_m") is None


def test_a_late_angle_of_attack_is_found_and_allowed_for():
    flights = []
    for i in range(2):
        flight = equipped(number=i, sign=(-1.0) ** i, noise=0.02, seed=i)
        alpha = flight.channels["alpha"]
        late = replace(alpha, t=alpha.t + 0.06)
        flights.append(replace(flight, channels={**flight.channels, "alpha": late}))
    found = estimate_jointly(flights, aircraft(accelerometer=Accelerometer(arm_m=0.0)))
    delay = found.instrument("alpha_delay_s")
    assert abs(delay.value - 0.06) < 3.0 * delay.std + 0.003
    assert np.all(
        np.abs(found.theta - UAV)[[1, 5, 6, 7]]
        < 4.0 * found.std[[1, 5, 6, 7]] + 0.02 * np.abs(UAV)[[1, 5, 6, 7]]
    )


def test_without_an_angle_of_attack_the_derivatives_come_from_pitch_rate_and_a_z():
    flights = [equipped(number=i, sign=(-1.0) ** i, noise=0.02, seed=i) for i in range(2)]
    found = estimate_jointly(flights, aircraft(alpha=Alpha(source="none")))
    assert found.outputs == ("q", "a_z")
    shared = [1, 5, 6, 7]
    assert np.all(np.abs(found.theta - UAV)[shared] < 4.0 * found.std[shared] + 0.03 * np.abs(UAV)[shared])
    assert set(found.not_identifiable) == {"Z_0", "M_0"}


def test_without_an_angle_of_attack_and_without_its_stand_in_there_is_no_estimate():
    flight = equipped(noise=0.02)
    channels = {name: c for name, c in flight.channels.items() if name not in ("alpha", "a_z")}
    found = estimate(replace(flight, channels=channels), aircraft())
    assert isinstance(found, NoEstimate)
    assert "a_z" in found.text


def test_no_lag_is_invented_where_there_is_none():
    flights = [equipped(number=i, sign=(-1.0) ** i, noise=0.05, seed=i) for i in range(3)]
    found = estimate_jointly(flights, Aircraft(airspeed_m_s=SPEED))
    assert np.all(
        np.abs(found.theta - UAV)[[1, 5, 6, 7]]
        < 4 * found.std[[1, 5, 6, 7]] + 0.02 * np.abs(UAV)[[1, 5, 6, 7]]
    )


@pytest.mark.parametrize("held", [False, True])
def test_the_servo_answers_as_the_differential_equation_says(held):
    t = np.array([0.0, 0.1, 0.2, 0.5])
    u = np.array([0.0, 0.0, 1.0, 0.5])
    grid = np.union1d(t + 0.05, np.arange(0.0, 0.9, 0.01))
    surface = Servo(0.08, 0.05).move(t, u, grid, held)[0]
    x, fine = 0.0, np.arange(0.0, 0.9, 1e-5)
    index = np.clip(np.searchsorted(t + 0.05, fine, side="right") - 1, 0, 3)
    command = u[index] if held else np.interp(fine - 0.05, t, u)
    path = []
    for value in command:
        path.append(x)
        x += 1e-5 * (value - x) / 0.08
    np.testing.assert_allclose(surface, np.interp(grid, fine, path), atol=5e-4)


def test_a_staircase_of_alpha_under_fresh_stamps_is_used_at_its_true_rate():
    flight = flown(UAV, unit_s=0.4, noise=0.01, length_s=9.0)
    alpha = flight.channels["alpha"]
    held = alpha.y[(np.arange(len(alpha)) // 3) * 3]
    channels = {"alpha": (alpha.t, held), "q": (flight.channels["q"].t, flight.channels["q"].y)}
    elevator = flight.channels["elevator"]
    found = estimate(maneuver(1, (elevator.t, elevator.y), channels), aircraft())
    assert len(found.fits[0]["alpha"].t) < len(alpha) / 2
    assert any("17 Hz" in note for note in found.notes)
    np.testing.assert_allclose(found.theta[[1, 5, 6, 7]], UAV[[1, 5, 6, 7]], rtol=0.05)


def test_speed_that_moves_scales_the_derivatives_to_one_speed():
    slow, fast = UAV.copy(), UAV.copy()
    powers = np.array([1, 1, 0, 1, 2, 2, 1, 2])
    # Z_0 holds gravity, g/V, besides the lift.
    for theta, ratio in ((slow, 0.9), (fast, 1.1)):
        theta[:] = UAV * ratio**powers
        theta[0] = (UAV[0] - GRAVITY / SPEED) * ratio + GRAVITY / (SPEED * ratio)
    flights = []
    for number, (theta, ratio) in enumerate(((slow, 0.9), (fast, 1.1))):
        flight = flown(theta, number=number, unit_s=0.4, length_s=9.0)
        t = flight.channels["elevator"].t
        channels = {n: (flight.channels[n].t, flight.channels[n].y) for n in ("alpha", "q")}
        channels["airspeed"] = (t, np.full(len(t), SPEED * ratio))
        flights.append(maneuver(number, (t, flight.channels["elevator"].y), channels))
    found = estimate_jointly(flights, aircraft(reference_airspeed_m_s=SPEED))
    np.testing.assert_allclose(found.theta, UAV, rtol=1e-3)
    assert found.airspeed_m_s == SPEED


def airspeed_channels(lag_s, noise=0.0):
    t = np.arange(0.0, 10.0, 0.02)
    alpha, theta = 0.05 + 0.02 * np.sin(3 * t), 0.05 + 0.15 * np.sin(0.9 * t)
    rate = 2.0 * np.cos(1.3 * t)
    speed = 24.0 + 2.0 * np.sin(1.3 * t) / 1.3
    a_z = -9.5 + 2.0 * np.sin(3 * t)
    a_x = (rate - a_z * np.sin(alpha) + GRAVITY * np.sin(theta - alpha)) / np.cos(alpha)
    coarse = np.arange(0.0, 10.0, 0.1)
    read = np.interp(coarse - lag_s, t, speed) + noise * np.random.default_rng(1).standard_normal(len(coarse))
    made = {"alpha": alpha, "theta": theta, "a_x": a_x, "a_z": a_z}
    channels = {name: Channel(name, t, y) for name, y in made.items()}
    return channels | {"airspeed": Channel("airspeed", coarse, read)}, Signal(t, speed)


@pytest.mark.parametrize("lag_s", [0.0, 0.3])
def test_a_late_air_speed_is_put_right_by_the_accelerometers(lag_s):
    channels, truth = airspeed_channels(lag_s, noise=0.05)
    found = airspeed(channels)
    assert found.smooth
    assert found.lag_s == pytest.approx(lag_s, abs=0.041)
    np.testing.assert_allclose(found.signal.at(truth.t), truth.y, atol=0.12)


def test_an_air_speed_that_disagrees_with_the_motion_is_believed():
    channels, _ = airspeed_channels(0.0)
    t = channels["airspeed"].t
    gusty = Channel("airspeed", t, 24.0 + 3.0 * np.sign(np.sin(5.0 * t)))
    found = airspeed(channels | {"airspeed": gusty})
    assert not found.smooth
    np.testing.assert_array_equal(found.signal.y, gusty.y)


def test_a_value_whose_error_reaches_the_end_of_the_search_is_no_estimate():
    problem = prepare([equipped()], Aircraft(airspeed_m_s=SPEED)).problem
    longest = replace(problem, servo=Servo(0.39))
    assert not SERVO_LAG.at_end(longest, std=0.003)
    assert SERVO_LAG.at_end(longest, std=0.03)
    assert SERVO_LAG.at_end(replace(problem, servo=Servo(0.4)), std=0.0)


def test_a_filtered_pitch_rate_and_specific_force_do_not_pass_for_other_derivatives():
    flight, late_s = equipped(noise=0.01), 0.011
    filtered = {
        name: replace(c, t=c.t + late_s, delay_s=late_s) if name in ("q", "a_z") else c
        for name, c in flight.channels.items()
    }
    there = estimate(replace(flight, channels=filtered), aircraft())
    np.testing.assert_allclose(there.theta, estimate(flight, aircraft()).theta, rtol=1e-6, atol=1e-6)


def test_a_lag_that_the_file_leaves_open_has_one_prior_on_every_axis():
    prepared = prepare([equipped(lag_s=0.1, noise=0.02)], Aircraft(airspeed_m_s=SPEED))
    pitch = {x.name: x.prior for x in unknown_instruments(prepared.problem, Aircraft(airspeed_m_s=SPEED))}
    doublet = flown_sideways(JET, aileron=aileron_doublet(np.arange(0.0, 15.0, 0.025)))
    rolled = AxisProblem(LATERAL, (doublet,))
    roll = {x.name: x.prior for x in parameters_of(rolled, Aircraft())}
    assert pitch["servo_lag_s"] == roll["aileron_lag_s"] == Prior(0.05, 0.05)


def test_a_stated_lag_is_first_estimated_with_the_usual_width_of_servos():
    stated = Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=0.0))
    prepared = prepare([equipped(lag_s=0.1, noise=0.02)], stated)
    (lag,) = (x for x in unknown_instruments(prepared.problem, stated) if x.name == "servo_lag_s")
    assert (lag.stated, lag.prior) == (0.0, Prior(0.0, 0.05))


def test_a_stated_zero_that_noisy_data_doubt_is_a_prior_and_every_interval_contains_the_doubt():
    stated = Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=0.0))
    found = estimate(equipped(lag_s=0.04, noise=0.3), stated)
    lag = found.instrument("servo_lag_s")
    assert not lag.contradicts
    assert abs(lag.value - 0.04) < 1.96 * lag.std
    assert np.all(np.abs(found.theta - UAV)[6:] < 1.96 * found.std[6:])


def test_a_stated_zero_that_noisy_data_confirm_holds_exactly():
    stated = Aircraft(airspeed_m_s=SPEED, elevator=Elevator(lag_s=0.0))
    assert estimate(equipped(noise=0.3), stated).instrument("servo_lag_s") is None


@pytest.mark.parametrize(("instrument", "contradicts"), [(COMMAND_DELAY, True), (SERVO_LAG, False)])
def test_a_value_far_from_its_prior_contradicts_a_delay_and_not_a_lag_that_other_flights_told(
    instrument, contradicts
):
    t = np.arange(0.0, 5.0, 0.02)
    record = Record(Signal(t, np.sin(t)), {})
    problem = OutputErrorProblem((record,), servo=Servo(lag_s=0.2, delay_s=0.2))
    far = replace(instrument, prior=Prior(0.05, 0.01))
    assert _identified(far, problem, 0.005).found.contradicts is contradicts
