"""The kinematic check tells instruments from aircraft without any aerodynamics."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.flight.instruments.delayed_fit import coloured_covariance
from advisor.flight.instruments.kinematics import check_alpha, combine
from tests.gap.generator import LIGHT_AIRCRAFT, Setup, fly
from tests.maneuvers import changed, without


def flown(seed=5, **changes):
    return fly(Setup(maneuvers=3, seed=seed, **changes))


def checked(**changes):
    return combine([check_alpha(m) for m in flown(**changes)])


def test_a_sound_alpha_is_consistent_whatever_the_aerodynamics():
    for frame in (Setup().airframe, LIGHT_AIRCRAFT, replace(Setup().airframe, cm_alpha=-2.0, cl_alpha=3.0)):
        found = checked(airframe=frame)
        assert found.finding == "consistent"
        assert abs(found.lag_s) < 0.003


@pytest.mark.parametrize("late_s", [-0.03, 0.02, 0.06])
def test_a_late_alpha_is_measured_with_its_error(late_s):
    found = checked(skew={"alpha": late_s})
    assert abs(found.lag_s - late_s) < 0.002 + 3 * found.lag_std_s
    assert found.finding == ("late" if late_s > 0 else "early")
    assert all(name in found.sentence for name in ("Z_δe", "Z_q", "Z_α", "M_q"))
    assert "not M_α and M_δe" in found.sentence


def test_a_scale_error_is_not_taken_for_a_lag():
    found = checked(alpha_scale=0.12)
    assert found.finding == "scaled"
    assert found.scale == pytest.approx(0.12, abs=0.02)


def test_the_climb_rate_shows_a_constant_offset():
    assert checked(alpha_bias=0.01).offset.rad == pytest.approx(0.01, abs=0.001)


@pytest.mark.parametrize("late_s", [0.0, 0.03])
def test_a_turn_spoils_neither_the_lag_nor_the_offset_of_alpha(late_s):
    found = checked(banks_deg=(25.0, -18.0, 10.0), alpha_bias=0.01, skew={"alpha": late_s})
    assert found.offset.rad == pytest.approx(0.01, abs=0.001)
    assert abs(found.lag_s - late_s) < 0.002 + 3 * found.lag_std_s


def test_a_constant_offset_shows_without_an_accelerometer_too():
    found = combine([check_alpha(m) for m in [without(one, "a_z") for one in flown(alpha_bias=0.01)]])
    assert found.finding == "not possible"
    assert found.offset.rad == pytest.approx(0.01, abs=0.001)


def test_a_known_accelerometer_arm_is_removed_and_an_unknown_one_is_not():
    maneuvers = flown(switches={"acc_arm": 0.4})
    known = combine([check_alpha(m, accelerometer_arm_m=0.4) for m in maneuvers])
    unknown = combine([check_alpha(m) for m in maneuvers])
    assert abs(known.lag_s) < 0.003 < abs(unknown.lag_s)


def test_a_known_place_of_the_vane_is_no_delay_and_an_unknown_one_is():
    maneuvers = flown(switches={"vane_arm": 0.4})
    known = combine([check_alpha(m, vane_arm_m=0.4) for m in maneuvers])
    unknown = combine([check_alpha(m) for m in maneuvers])
    assert known.finding == "consistent"
    assert unknown.lag_s == pytest.approx(0.4 / 22.0, rel=0.2)


def test_a_repeated_alpha_is_used_at_its_true_rate():
    maneuver = flown()[0]
    channel = maneuver.channels["alpha"]
    held = np.repeat(channel.y[::3], 3)[: len(channel)]
    staircase = changed(maneuver, "alpha", y=held)
    assert abs(check_alpha(staircase).lag_s) < 0.005


@pytest.mark.parametrize("absent", ["a_z", "theta", "airspeed"])
def test_missing_channels_are_named_instead_of_guessed(absent):
    maneuver = flown()[0]
    channels = {k: v for k, v in maneuver.channels.items() if k != absent}
    found = check_alpha(replace(maneuver, channels=channels))
    assert not found.possible
    assert found.sentence.endswith(f": no {absent} in this log.")


def test_errors_of_a_coloured_fit_are_wider_than_those_of_a_white_one():
    rng = np.random.default_rng(1)
    slow = np.cumsum(rng.standard_normal(400)) * 0.1
    jacobian = np.column_stack([np.ones(400), np.linspace(-1, 1, 400)])
    plain = np.linalg.inv(jacobian.T @ jacobian) * float(slow @ slow) / 398
    assert np.all(np.diag(coloured_covariance(jacobian, slow)) > 4 * np.diag(plain))


def test_air_that_begins_to_sink_is_no_offset_of_the_angle_of_attack():
    offset, sunk = [], []
    for m in flown():
        alpha = m.channels["alpha"]
        began = alpha.t > alpha.t[0] + 2.5
        for course, shift in ((offset, np.full(len(alpha), -0.03)), (sunk, -0.03 * began)):
            course.append(changed(m, "alpha", y=alpha.y + shift))
    constant, begun = (combine([check_alpha(m) for m in course]) for course in (offset, sunk))
    assert constant.offset.stays
    assert constant.offset.rad == pytest.approx(-0.03, abs=0.003)
    assert not begun.offset.stays


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_vane_that_reads_gusts_is_neither_late_nor_scaled(seed):
    found = checked(gust_std=0.3, seed=seed)
    assert found.finding == "consistent"
    assert abs(found.lag_s) < 3.0 * found.lag_std_s


def test_a_late_vane_is_late_by_as_much_in_air_that_moves():
    found = checked(gust_std=0.3, skew={"alpha": 0.06}, seed=3)
    assert found.finding == "late"
    assert abs(found.lag_s - 0.06) < 3.0 * found.lag_std_s
