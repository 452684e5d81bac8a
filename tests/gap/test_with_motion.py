"""A law that a simulator lacks acts with the motion, in every manoeuvre again; air and noise do not."""

import numpy as np
import pytest

from advisor.gap.inference.with_motion import moving_power

MOTION = np.array([0.0, 0.0, 4.0, 9.0, 4.0, 1.0, 0.0, 0.0])
"""Mean square of the motion in eight bins: rest, an input, decay, rest."""
ALONE = MOTION[None]
"""Motion of a single output."""


def test_a_residual_that_follows_the_motion_counts_whole():
    power, error, _ = moving_power([0.1 * MOTION] * 4, [ALONE] * 4)
    assert power == pytest.approx(0.1 * np.mean(MOTION))
    assert error == pytest.approx(0.0, abs=1e-12)


def test_a_residual_as_strong_at_rest_as_in_motion_counts_nothing():
    assert moving_power([np.full(8, 3.0)] * 4, [ALONE] * 4)[0] == pytest.approx(0.0, abs=1e-12)


def test_a_level_of_each_manoeuvre_changes_nothing():
    levels = [level + 0.1 * MOTION for level in (0.0, 5.0, 1.0, 9.0)]
    assert moving_power(levels, [ALONE] * 4)[0] == pytest.approx(0.1 * np.mean(MOTION))


def test_a_residual_of_one_manoeuvre_alone_does_not_repeat():
    once = [0.4 * MOTION, *[0.0 * MOTION] * 3]
    power, error, freedom = moving_power(once, [ALONE] * 4)
    assert error == pytest.approx(power)
    assert freedom == 3


def test_two_manoeuvres_show_nothing_that_repeats():
    assert moving_power([0.1 * MOTION] * 2, [ALONE] * 2)[0] == 0.0


def test_without_motion_nothing_grows_with_it():
    assert moving_power([np.ones(8)] * 3, [np.zeros((1, 8))] * 3)[0] == 0.0


def test_a_residual_with_one_output_repeats_whatever_the_others_do():
    """Aileron and rudder inputs move roll and yaw differently, and the residual follows yaw alone."""
    roll, yaw = np.roll(MOTION, 1), MOTION
    motions = [np.array([a * roll, b * yaw]) for a, b in ((9.0, 1.0), (1.0, 5.0), (8.0, 1.0), (0.5, 6.0))]
    power, error, _ = moving_power([0.1 * motion[1] for motion in motions], motions)
    assert power == pytest.approx(0.1 * 13.0 / 4.0 * np.mean(yaw))
    assert error < 1e-9
