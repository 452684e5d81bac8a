"""The odds that the aircraft file's derivatives are wrong, on hand-made estimates."""

import numpy as np
import pytest

from advisor.gap.fitting.prior import derivative_scale
from advisor.gap.inference.prior_speed import evidence_of_file

FILE = np.array([-4.3, -0.03, -0.29, -37.5, -4.7, -52.0])
"""Z_α, Z_q, Z_δe, M_α, M_q, M_δe of a small unmanned aircraft."""
KNOWN = np.diag((1e-3 * derivative_scale(FILE)) ** 2)


def fitted(**off):
    """Return derivatives that differ from the file's by shares of their size."""
    places = ["z_alpha", "z_q", "z_delta_e", "m_alpha", "m_q", "m_delta_e"]
    return FILE + derivative_scale(FILE) * np.array([off.get(place, 0.0) for place in places])


def odds(derivatives, known):
    """Return the log odds of wrong derivatives in the file."""
    told = evidence_of_file(derivatives, known, FILE)
    return told.wrong - told.right


def test_one_number_that_is_12_percent_off_is_wrong_though_five_are_right():
    assert odds(fitted(m_delta_e=0.12), KNOWN) > 0.0


def test_a_number_that_is_6_percent_off_is_as_the_linearisation_leaves_it():
    assert odds(fitted(m_delta_e=0.06), KNOWN) < 0.0


def test_six_numbers_that_are_3_percent_off_are_right():
    assert odds(FILE + 0.03 * derivative_scale(FILE), KNOWN) < 0.0


def test_a_flight_that_tells_nothing_leaves_the_odds_even():
    blind = np.diag((100.0 * derivative_scale(FILE)) ** 2)
    assert odds(fitted(m_delta_e=0.5), blind) == pytest.approx(0.0, abs=1e-3)


def test_a_number_that_the_flight_does_not_tell_makes_no_file_wrong():
    unsure = KNOWN.copy()
    unsure[5, 5] = (0.12 * derivative_scale(FILE)[5]) ** 2
    assert odds(fitted(m_delta_e=0.12), unsure) < 0.0
