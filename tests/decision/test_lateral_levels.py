"""The boundaries of Tables VI to VIII of MIL-F-8785C, each passed from one side to the other."""

from math import log

import numpy as np
import pytest

from advisor.decision.axes.lateral_requirements import (
    dutch_roll_tests,
    lateral_levels,
    lateral_qualification,
    peak_roll_rate,
)
from advisor.model.axes.lateral import LATERAL, Trim, state_matrix
from advisor.oem.flying_qualities import Quality
from tests.oem.axis.builders import JET, vector

BELOW, ABOVE = 1.0 - 1e-9, 1.0 + 1e-9
NAMES = {
    "dutch_roll_omega": "omega", "dutch_roll_zeta": "zeta", "roll_time_constant": "roll",
    "spiral_pole": "pole",
}  # fmt: skip
GOOD = {"omega": 3.0, "zeta": 0.5, "roll": 0.5, "pole": -0.01}


def modes(std=0.0, **changed):
    v = GOOD | changed
    return {name: Quality(v[short], std) for name, short in NAMES.items()}


def levels_of(mode, **changed):
    """Return the levels of one mode: classes I, II-C, IV in A, B, C, then II-L, III in A, B, C."""
    return "".join(str(one.by_mode[mode].level) for one in lateral_levels(modes(**changed)))


@pytest.mark.parametrize(
    ("zeta", "omega", "levels"),
    [
        (0.5, 1.0 * ABOVE, "111111"),
        (0.5, 1.0 * BELOW, "212111"),
        (0.95, 0.4 * ABOVE, "212111"),
        (0.95, 0.4 * BELOW, "444444"),
        (0.19 * ABOVE, 3.0, "111111"),
        (0.19 * BELOW, 3.0, "211211"),
        (0.08 * ABOVE, 3.0, "211211"),
        (0.08 * BELOW, 3.0, "222222"),
        (0.02 * ABOVE, 3.0, "222222"),
        (0.02 * BELOW, 3.0, "333333"),
        (-1e-9, 3.0, "444444"),
        (0.35 / 1.5 * BELOW, 1.5, "211211"),
        (0.35 / 1.5 * ABOVE, 1.5, "111111"),
        (0.15 / 1.2 * BELOW, 1.2, "222221"),
        (0.10 / 1.2 * BELOW, 1.2, "222222"),
        (0.05 / 1.2 * BELOW, 1.2, "333333"),
    ],
)
def test_the_dutch_roll_by_frequency_damping_and_their_product(zeta, omega, levels):
    assert levels_of("dutch_roll", zeta=zeta, omega=omega) == levels


@pytest.mark.parametrize(
    ("constant", "levels"),
    [
        (1.0 * BELOW, "111111"), (1.0 * ABOVE, "212111"), (1.4 * ABOVE, "323222"), (3.0 * ABOVE, "333333"),
        (10.0 * BELOW, "333333"), (10.0 * ABOVE, "444444"),
    ],
)  # fmt: skip
def test_the_time_constant_of_the_roll_mode(constant, levels):
    assert levels_of("roll", roll=constant) == levels


@pytest.mark.parametrize(
    ("doubled", "levels"),
    [
        (20.0 * ABOVE, "111111"), (20.0 * BELOW, "121121"), (12.0 * ABOVE, "121121"),
        (12.0 * BELOW, "222222"), (8.0 * BELOW, "333333"), (4.0 * BELOW, "444444"),
    ],
)  # fmt: skip
def test_the_time_to_double_the_bank_in_the_spiral(doubled, levels):
    assert levels_of("spiral", pole=log(2.0) / doubled) == levels


def test_a_spiral_that_converges_is_level_1():
    assert levels_of("spiral", pole=-1e-6) == "111111"


def test_the_worst_mode_governs_and_the_intervals_say_which_levels_they_reach():
    first = lateral_levels(modes(zeta=0.1, roll=2.0))[0]
    assert (first.by_mode["dutch_roll"].level, first.by_mode["roll"].level, first.governing.level) == (
        2,
        3,
        3,
    )
    unsure = lateral_levels(modes(std=0.1, roll=1.1))[0].by_mode["roll"]
    assert (unsure.best_level, unsure.level, unsure.worst_level) == (1, 2, 2)


def test_a_mode_that_is_not_told_has_no_level():
    without = {"dutch_roll_omega": Quality(3.0, 0.0), "dutch_roll_zeta": Quality(0.5, 0.0)}
    assert all(set(one.by_mode) == {"dutch_roll"} for one in lateral_levels(without))
    assert lateral_levels({}) == ()


TRIM = Trim(130.0, 0.07, 0.105)
ABOVE, BELOW = 1.0 + 1e-9, 1.0 - 1e-9


def with_(**changed):
    return vector(JET | changed)


def dutch(period_s=2.0, zeta=0.1):
    damped = 2.0 * np.pi / period_s
    omega = damped / np.sqrt(1.0 - zeta**2)
    return complex(-zeta * omega, damped)


@pytest.mark.parametrize(
    ("period_s", "holds"), [(2.2 * BELOW, True), (2.2 * ABOVE, False), (1.8 * BELOW, False)]
)
def test_the_period_of_the_dutch_roll_may_be_off_by_a_tenth(period_s, holds):
    period, _ = dutch_roll_tests(dutch(), dutch(period_s))
    assert period.holds is holds


@pytest.mark.parametrize(("zeta", "holds"), [(0.12 * BELOW, True), (0.1201, False), (0.0799, False)])
def test_a_light_damping_may_be_off_by_two_hundredths(zeta, holds):
    _, damping = dutch_roll_tests(dutch(), dutch(zeta=zeta))
    assert damping.holds is holds
    assert damping.name == "Dutch roll damping"


def test_a_strong_damping_may_be_off_by_a_tenth_of_the_time_to_half_amplitude():
    _, damping = dutch_roll_tests(dutch(zeta=0.5), dutch(zeta=0.525))
    assert damping.holds
    assert damping.name == "time to half amplitude"


def test_the_roll_rate_of_a_pure_roll_is_that_of_its_closed_form():
    theta = vector(dict.fromkeys(JET, 0.0) | {"L_p": -2.0, "L_delta_a": -6.0})
    found = peak_roll_rate(theta, state_matrix(theta, Trim(130.0)), -0.1, 1.5)
    assert found == pytest.approx(0.3 * (1.0 - np.exp(-3.0)), rel=1e-6)


def test_a_fast_roll_may_be_off_by_a_tenth_and_a_slow_one_by_2_deg_s():
    for size, power, holds in ((0.2, 1.09, True), (0.2, 1.11, False), (0.01, 1.5, True)):
        off = with_(L_delta_a=power * JET["L_delta_a"], N_delta_a=power * JET["N_delta_a"],
                    Y_delta_a=power * JET["Y_delta_a"])  # fmt: skip
        roll = lateral_qualification(with_(), off, TRIM, size, 1.0)[0]
        assert roll.holds is holds
        assert roll.simulated == pytest.approx(power * roll.flown)


def test_equal_derivatives_hold_every_test():
    tests = lateral_qualification(with_(), with_(), TRIM, 0.1, 1.0)
    assert [one.entry for one in tests] == ["2.d.2", "2.d.7", "2.d.7"]
    assert all(one.holds and one.flown == one.simulated for one in tests)
    assert len(LATERAL.names.reported) == 15
