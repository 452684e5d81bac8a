"""Manoeuvres flown in turns: the pitch angle is not the integral of the pitch rate there."""

import numpy as np
import pytest

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.derived_alpha import derived_alpha, gravity_in_plane

BANKS = (-8.0, 14.0, 3.0, -20.0, 25.0)


def test_gravity_in_the_plane_of_symmetry_is_the_down_axis_without_its_sideways_part():
    theta, bank, alpha = np.array([0.2, -0.1, 0.3]), np.array([0.5, -0.3, 0.0]), np.array([0.1, 0.05, 0.2])
    up, size = gravity_in_plane(theta, bank)
    down = GRAVITY_M_S2 * np.array([-np.sin(theta), np.cos(theta) * np.cos(bank)])
    across = down[1] * np.cos(alpha) - down[0] * np.sin(alpha)
    along = down[0] * np.cos(alpha) + down[1] * np.sin(alpha)
    np.testing.assert_allclose(size * np.cos(up - alpha), across)
    np.testing.assert_allclose(-size * np.sin(up - alpha), along)


def test_in_a_bank_alpha_is_what_brings_that_path_about():
    alpha, theta, bank, speed = 0.08, 0.11, 0.5, 25.0
    sine = np.cos(alpha) * np.sin(theta) - np.sin(alpha) * np.cos(bank) * np.cos(theta)
    found = derived_alpha(*(np.array([value]) for value in (speed * sine, speed, theta, bank)))
    assert found[0] == pytest.approx(alpha, abs=1e-9)
