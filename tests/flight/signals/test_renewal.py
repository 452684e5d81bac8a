"""What is sent again under fresh stamps is no new value; a sensor that is stuck is."""

import numpy as np
import pytest

from advisor.flight.signals.renewal import renewed

T = 0.02 * np.arange(500)


def test_a_staircase_counts_once_a_step():
    held = np.sin(2.0 * np.floor(T * 20.0) / 20.0)
    t, y = renewed(T, held)
    assert len(t) == pytest.approx(20.0 * T[-1], abs=2)
    assert np.all(np.diff(y) != 0.0)


def test_a_channel_that_is_new_in_nearly_every_sample_stays_as_it_is():
    values = np.sin(2.0 * T)
    values[::10] = values[1::10]
    t, y = renewed(T, values)
    assert len(t) == len(T)
    assert np.array_equal(y, values)


def test_a_sensor_that_is_stuck_was_read_all_the_same():
    coarse = np.round(np.sin(0.5 * T) / 0.3) * 0.3
    t, y = renewed(T, coarse, fewest=30)
    assert len(t) == len(T)
    assert np.array_equal(y, coarse)
