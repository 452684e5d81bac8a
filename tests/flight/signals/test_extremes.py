"""A whole flight in bounded memory loses no peak."""

import numpy as np
import pytest

from advisor.flight.signals.power_on import Extremes


@pytest.mark.parametrize("seconds", [30.0, 4000.0])
def test_a_single_peak_is_seen_however_long_the_flight(seconds: float) -> None:
    t = np.arange(0.0, seconds, 0.1)
    y = np.zeros(len(t))
    y[len(t) // 3] = 5.0
    found = Extremes()
    for part in np.array_split(np.arange(len(t)), 50):
        found.add(t[part], y[part])
    course = found.course
    assert len(course.t) <= 600
    assert course.high.max() == 5.0
    assert abs(course.t[np.argmax(course.high)] - t[len(t) // 3]) < seconds / 100.0
    assert course.low.max() == 0.0


def test_the_batches_do_not_matter() -> None:
    random = np.random.default_rng(1)
    t, y = np.sort(random.uniform(10.0, 900.0, 5000)), random.normal(size=5000)
    whole, parts = Extremes(), Extremes()
    whole.add(t, y)
    for k in range(0, 5000, 7):
        parts.add(t[k : k + 7], y[k : k + 7])
    assert np.array_equal(whole.course.high, parts.course.high)
    assert np.array_equal(whole.course.low, parts.course.low)


def test_a_silence_is_a_gap() -> None:
    found = Extremes()
    found.add(np.array([0.0, 0.1, 60.0]), np.array([1.0, 2.0, 3.0]))
    assert len(found.course.t) == 2


def test_a_stamp_that_rounds_up_to_the_end_has_a_place() -> None:
    begin_s = 33.586
    stamp_s = np.nextafter(begin_s + 150.0, 0.0)
    found = Extremes()
    found.add(np.array([begin_s, stamp_s]), np.array([1.0, 2.0]))
    assert found.course.high.max() == 2.0
