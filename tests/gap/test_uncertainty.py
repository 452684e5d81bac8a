"""How far a size is from nothing does not hang on where, when or how fast."""

import numpy as np
import pytest

from advisor.gap.fitting.uncertainty import sigmas_of


def test_a_size_that_trades_against_its_place_counts_as_if_that_were_known():
    known = np.array([[4.0, 1.8], [1.8, 1.0]])
    given = np.sqrt(4.0 - 1.8**2 / 1.0)
    assert sigmas_of(np.array([1.0, 50.0]), known, [False, True]) == pytest.approx(1.0 / given)
    assert sigmas_of(np.array([1.0, -7e9]), known, [False, True]) == pytest.approx(1.0 / given)


def test_without_a_place_the_number_that_is_farthest_from_nothing_counts():
    known = np.diag([4.0, 0.25])
    assert sigmas_of(np.array([3.0, -2.0]), known, [False, False]) == pytest.approx(4.0)
