"""The common grid: the pace of the pitch rate, linear between stamps, nothing where nothing is known."""

import numpy as np

from advisor.exports.flights.reading import grid_times, on_grid, on_one_grid
from advisor.flight.signals.record import Channel


def channel(name: str, t: list[float], y: list[float]) -> Channel:
    return Channel(name, np.array(t), np.array(y), "TEST.field", "measured")


Q = channel("q", [1.0, 1.1, 1.2, 1.3, 1.4], [0.0, 1.0, 2.0, 3.0, 4.0])


def test_the_grid_has_the_pace_and_the_ends_of_the_pitch_rate() -> None:
    fast = channel("elevator", [0.0, 0.01, 0.02, 5.0], [0.0] * 4)
    np.testing.assert_allclose(grid_times({"elevator": fast, "q": Q}), [1.0, 1.1, 1.2, 1.3, 1.4])


def test_without_a_pitch_rate_the_fastest_channel_gives_the_pace() -> None:
    slow = channel("height", [0.0, 1.0, 2.0], [0.0] * 3)
    fast = channel("theta", [0.0, 0.5, 1.0], [0.0] * 3)
    np.testing.assert_allclose(grid_times({"height": slow, "theta": fast}), [0.0, 0.5, 1.0])


def test_values_between_stamps_are_linear_and_outside_them_unknown() -> None:
    slow = channel("alpha", [1.05, 1.25], [0.0, 2.0])
    np.testing.assert_allclose(on_grid(slow, grid_times({"q": Q})), [np.nan, 0.5, 1.5, np.nan, np.nan])


def test_in_a_long_gap_nothing_is_known_and_at_its_ends_the_samples_stand() -> None:
    t = np.array([0.0, 0.1, 0.2, 1.0, 2.2, 2.3])
    lost = channel("alpha", [0.0, 0.1, 0.2, 2.2, 2.3], [0.0, 1.0, 2.0, 3.0, 4.0])
    np.testing.assert_allclose(on_grid(lost, t), [0.0, 1.0, 2.0, np.nan, 3.0, 4.0])


def test_a_channel_that_comes_once_a_second_has_no_gaps() -> None:
    slow = channel("airspeed", [0.0, 1.0, 2.5, 3.5, 4.5], [0.0, 1.0, 2.5, 3.5, 4.5])
    t = np.linspace(0.0, 4.5, 46)
    np.testing.assert_allclose(on_grid(slow, t), t)


def test_without_channels_the_grid_has_no_rows() -> None:
    assert len(on_one_grid({})) == 0
