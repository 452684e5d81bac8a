"""The lateral tolerances of 14 CFR Part 60, each passed from one side to the other."""

import numpy as np
import pytest

from advisor.decision.axes.lateral_requirements import (
    dutch_roll_tests,
    lateral_qualification,
    peak_roll_rate,
)
from advisor.model.axes.lateral import LATERAL, Trim, state_matrix
from tests.oem.axis.builders import JET, vector

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
