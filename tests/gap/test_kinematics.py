"""The kinematic check tells instruments from aircraft without any aerodynamics."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.flight.instruments.delayed_fit import coloured_covariance
from advisor.flight.instruments.kinematics import check_alpha, combine
from advisor.gap.uncatalogued.wind_shear import wind_shear
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


def blown(maneuver, gradient):
    """Return the manoeuvre in a wind that changes with height."""
    speed, climb = maneuver.channels["airspeed"], maneuver.channels["climb_rate"]
    height = np.concatenate(([0.0], np.cumsum(np.diff(climb.t) * (climb.y[1:] + climb.y[:-1]) / 2.0)))
    y = speed.y + gradient * np.interp(speed.t, climb.t, height)
    return changed(maneuver, "airspeed", y=y)


def test_heights_that_explain_next_to_nothing_of_the_air_speeds_own_motion_are_no_wind():
    rng, swung = np.random.default_rng(3), []
    for maneuver in fly(Setup(maneuvers=5, seed=52)):
        sheared = blown(maneuver, 0.15)
        speed = sheared.channels["airspeed"]
        y = speed.y + 1.2 * np.sin(2.0 * np.pi * (0.4 * speed.t + rng.random()))
        swung.append(changed(sheared, "airspeed", y=y))
    assert wind_shear(swung) is None


def late(maneuver, by_s):
    """Return the manoeuvre in a wind that changes with height, with a filtered air speed."""
    speed = maneuver.channels["airspeed"]
    y = speed.y.copy()
    for i in range(1, len(y)):
        y[i] = y[i - 1] + (speed.y[i] - y[i - 1]) * -np.expm1((speed.t[i - 1] - speed.t[i]) / by_s)
    return changed(maneuver, "airspeed", y=y)


def test_no_wind_changes_by_most_of_its_own_speed_in_a_metre():
    still = fly(Setup(maneuvers=5, seed=51))
    assert not wind_shear([blown(m, 0.4) for m in still]).is_implausible
    assert wind_shear([blown(m, 0.7) for m in still]).is_implausible


@pytest.mark.parametrize("by_s", [0.3, 0.6])
def test_an_air_speed_that_is_late_is_no_wind_and_hides_none(by_s):
    still = fly(Setup(maneuvers=6, seed=3, speed_change=0.05))
    assert wind_shear([late(m, by_s) for m in still]) is None
    assert wind_shear([late(blown(m, 0.2), by_s) for m in still]).gradient_per_s > 0.1


def test_wind_that_changes_with_height_shows_in_the_air_speed_and_nowhere_else():
    still = fly(Setup(maneuvers=5, seed=51))
    assert wind_shear(still) is None
    sheared = [blown(m, 0.2) for m in still]
    found = wind_shear(sheared)
    assert found is not None
    assert found.gradient_per_s == pytest.approx(0.2, abs=4.0 * found.std)
    # Three manoeuvres may agree by chance.
    assert wind_shear(sheared[:3]) is None


def test_a_wind_that_all_manoeuvres_agree_on_is_plain_though_the_air_speed_is_rough():
    rng, rough = np.random.default_rng(3), []
    for maneuver in fly(Setup(seed=51)):
        sheared = blown(maneuver, 0.2)
        speed = sheared.channels["airspeed"]
        y = speed.y + 0.4 * rng.standard_normal(len(speed.y))
        rough.append(changed(sheared, "airspeed", y=y))
    found = wind_shear(rough)
    assert found.share < 0.25
    assert found.gradient_per_s == pytest.approx(0.2, abs=0.05)


def test_a_rough_beginning_of_the_records_makes_no_air_speed_late():
    rng, shaken = np.random.default_rng(3), []
    for maneuver in fly(Setup(maneuvers=6, seed=51)):
        sheared = blown(maneuver, 0.2)
        speed = sheared.channels["airspeed"]
        noise = np.where(speed.t - speed.t[0] < 0.9, 0.7, 0.03) * rng.standard_normal(len(speed.t))
        shaken.append(changed(sheared, "airspeed", y=speed.y + noise))
    assert wind_shear(shaken).gradient_per_s == pytest.approx(0.2, abs=0.02)


@pytest.mark.parametrize("seed", [3, 4, 5])
def test_a_vane_that_reads_gusts_is_neither_late_nor_scaled(seed):
    found = checked(gust_std=0.3, seed=seed)
    assert found.finding == "consistent"
    assert abs(found.lag_s) < 3.0 * found.lag_std_s


def test_a_late_vane_is_late_by_as_much_in_air_that_moves():
    found = checked(gust_std=0.3, skew={"alpha": 0.06}, seed=3)
    assert found.finding == "late"
    assert abs(found.lag_s - 0.06) < 3.0 * found.lag_std_s


def test_a_wind_that_changes_in_a_layer_only_is_told_by_the_manoeuvres_flown_in_it():
    heights = (150.0, 40.0, 152.0, 60.0, 148.0, 30.0, 155.0, 50.0, 145.0)
    flown = fly(Setup(seed=9, heights_m=heights))
    layered = [blown(m, 0.2) if h > 100.0 else m for m, h in zip(flown, heights, strict=True)]
    assert wind_shear(flown) is None
    found = wind_shear(layered)
    assert abs(found.gradient_per_s - 0.2) < 0.05
    # Winds of every second manoeuvre in height make no layer.
    low_to_high = [m for _, m in sorted(zip(heights, flown, strict=True), key=lambda pair: pair[0])]
    assert wind_shear([blown(m, 0.2) if k % 2 else m for k, m in enumerate(low_to_high)]) is None


def test_a_layer_of_wind_is_told_by_two_manoeuvres_that_cross_its_edge():
    heights = (150.0, 40.0, 220.0, 60.0, 151.0, 30.0, 260.0, 50.0, 300.0)
    sheared = []
    for m in fly(Setup(seed=11, heights_m=heights)):
        speed, height = m.channels["airspeed"], m.channels["height"]
        wind = 0.4 * np.clip(np.interp(speed.t, height.t, height.y) - 150.0, -10.0, 10.0)
        sheared.append(changed(m, "airspeed", y=speed.y + wind))
    found = wind_shear(sheared)
    assert abs(found.gradient_per_s - 0.4) < 0.1
    # One that was flown in it agrees with no other.
    assert wind_shear([m for k, m in enumerate(sheared) if k != 4]) is None
