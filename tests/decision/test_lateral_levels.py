"""The boundaries of Tables VI to VIII of MIL-F-8785C, each passed from one side to the other."""

from math import log

import pytest

from advisor.decision.axes.lateral_requirements import lateral_levels
from advisor.oem.flying_qualities import Quality

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
