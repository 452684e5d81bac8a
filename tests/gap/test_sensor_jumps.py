"""A sensor that jumps: one sample in two hundred, far beyond its roughness, and hardly another sensor."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.uncatalogued.sensor_jumps import jumping_sensor

CHANNELS = ("alpha", "q", "a_z")
N = 2001
T = np.arange(N) * 0.02


def judged(jumps, *, size=30.0, surprise=30.0, telling=(0, 1, 2), quiet=True, stamps=T, tolerance=0.0):
    """Return the sensor that jumps, where each channel steps up and down ``jumps`` times.

    Sizes are in units of the noise. A step changes the level of the residual, and its interval is
    the jump.
    """
    rng = np.random.default_rng(7)
    residual, innovations = rng.standard_normal((2, len(CHANNELS), N))
    for row, count in enumerate(jumps):
        at = np.linspace(10, N - 10, count).astype(int)
        for step, k in enumerate(at):
            residual[row, k:] += size * (-1) ** step
        innovations[row, at] = surprise
    flight = SimpleNamespace(
        outputs={name: SimpleNamespace(t=stamps) for name in CHANNELS},
        is_quiet=lambda t: np.full(len(t), quiet),
    )
    problem = SimpleNamespace(
        channels=CHANNELS,
        flights=SimpleNamespace(flights=[flight], telling=telling),
        rows=lambda flight: [slice(row * N, (row + 1) * N) for row in range(len(CHANNELS))],
    )
    last = SimpleNamespace(residuals=[residual.ravel()], innovations=[innovations.ravel()])
    return jumping_sensor(problem, last, np.full(len(CHANNELS), tolerance))


@pytest.mark.parametrize(("count", "block"), [(8, None), (12, "pitch_rate_sensor")])
def test_a_sensor_jumps_from_one_sample_in_two_hundred(count, block):
    assert judged((0, count, 0)) == block


@pytest.mark.parametrize(("other", "block"), [(12, None), (8, "alpha_sensor")])
def test_jumps_in_a_second_sensor_are_a_gust_or_a_knock(other, block):
    assert judged((20, other, 0)) == block


def test_a_change_that_the_filter_expects_is_no_jump():
    assert judged((0, 0, 20), surprise=2.0) is None


@pytest.mark.parametrize(("size", "block"), [(4.0, None), (12.0, "accelerometer")])
def test_a_jump_exceeds_six_standard_deviations_of_the_changes(size, block):
    """The standard deviation of a change of white noise is 1.4 in these units."""
    assert judged((0, 0, 20), size=size) == block


def test_a_jump_within_the_noise_assumed_for_a_filtered_channel_is_none():
    assert judged((0, 0, 20), tolerance=15.0) is None


def test_jumps_while_the_stick_moves_do_not_count():
    assert judged((0, 20, 0), quiet=False) is None


def test_an_autopilots_estimate_is_not_judged():
    assert judged((20, 0, 0), telling=(1, 2)) is None
