"""An instrument behind a filter that nobody compensates is late, and rounds what it reads."""

import numpy as np
import pytest
from scipy.signal import lsim

from advisor.gap.simulator.reading import filtered, lane, packed


@pytest.mark.parametrize("shape", [0.0, 0.25, 0.5])
def test_a_filtered_output_is_what_another_code_makes_of_it_and_the_others_stay(shape):
    h, late = 0.005, 0.07
    t = h * np.arange(1500)
    motion = np.array([np.sin(3.0 * t), np.sin(7.0 * t), 5.0 * np.cos(4.0 * t), np.minimum(t, 1.0)])
    passed = lane(
        filtered(packed([motion]), h, np.zeros(1, dtype=np.int64), np.array([[late, shape, 1.0]])), 0
    )
    expected = lsim(([1.0], [max(shape, 1e-4) * late**2, late, 1.0]), motion[1], t)[1]
    assert passed[1] == pytest.approx(expected, abs=2e-3)
    assert passed[[0, 2, 3]] == pytest.approx(motion[[0, 2, 3]])


def test_without_a_lag_nothing_is_filtered():
    motion = np.random.default_rng(3).standard_normal((4, 100))
    passed = lane(filtered(packed([motion]), 0.005, np.zeros(1, dtype=np.int64), np.zeros((1, 3))), 0)
    assert passed == pytest.approx(motion)
