"""What is sent again under fresh stamps is no new value; a sensor that is stuck is."""

import numpy as np
import pytest

from advisor.flight.signals.record import Channel, counted_once, renewed

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


def channel(y: np.ndarray, t: np.ndarray = T) -> Channel:
    return Channel("elevator", t[: len(y)], y)


def noise(n: int) -> np.ndarray:
    return np.random.default_rng(5).standard_normal(n)


@pytest.mark.parametrize("copies", [2, 3, 4])
def test_of_a_value_sent_several_times_the_first_copy_counts(copies: int) -> None:
    once = noise(100)
    found = counted_once(channel(np.repeat(once, copies)))
    assert found.y[1:].tolist() == once[1:].tolist()
    assert found.t[1:].tolist() == T[copies : 100 * copies : copies].tolist()


def test_a_record_may_begin_with_a_second_copy() -> None:
    once = noise(100)
    found = counted_once(channel(np.repeat(once, 2)[1:]))
    assert found.y.tolist() == once[1:].tolist()


def test_a_held_elevator_sent_twice_keeps_its_held_samples() -> None:
    """Without them a step after a rest would become a ramp over the rest."""
    once = np.repeat([0.0, 1.0, 0.0], 60)
    once[60:120] += 0.01 * np.round(noise(60))
    found = counted_once(channel(np.repeat(once, 2)))
    assert found.y.tolist() == once.tolist()


def test_a_held_elevator_that_is_sent_once_stays_as_it_is() -> None:
    held = np.repeat([0.0, 1.0, -1.0, 1.0, -1.0, 0.0], 30)
    assert len(counted_once(channel(held))) == len(held)


def test_a_channel_that_never_changes_stays_as_it_is() -> None:
    assert len(counted_once(channel(np.ones(200)))) == 200


def test_noise_stays_as_it_is() -> None:
    assert len(counted_once(channel(noise(300)))) == 300
