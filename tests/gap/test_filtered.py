"""An instrument behind a filter that nobody compensates is late, and rounds what it reads."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import lsim

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.simulator.reading import filtered, lane, packed
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly


def through(channel, late_s, shape):
    """Return a channel behind a filter 1/(1 + T p + c T² p²)."""
    t = np.arange(channel.t[0], channel.t[-1] + 1e-9, 0.002)
    bias = np.median(channel.y[:20])
    passed = lsim(
        ([1.0], [max(shape, 1e-4) * late_s**2, late_s, 1.0]),
        np.interp(t, channel.t, channel.y) - bias,
        t - t[0],
    )[1]
    return replace(channel, y=bias + np.interp(channel.t, t, passed))


def with_filter(setup, channel, late_s, shape):
    return [
        replace(m, channels={**m.channels, channel: through(m.channels[channel], late_s, shape)})
        for m in fly(setup)
    ]


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


@pytest.mark.study
@pytest.mark.parametrize(
    ("channel", "late_s", "shape", "block"),
    [
        ("q", 0.1, 0.5, "pitch_rate_sensor"),
        ("theta", 0.16, 0.0, "attitude_sensor"),
        ("a_z", 0.1, 0.0, "accelerometer"),
    ],
)
def test_a_channel_behind_a_filter_is_unknown_in_its_instrument_and_not_merely_late(
    channel, late_s, shape, block
):
    found = diagnose(with_filter(Setup(maneuvers=6, seed=51), channel, late_s, shape), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", block)
    (note,) = (note for note in found.notes if "passes a filter" in note)
    said = float(note.split("it is ")[1].split(" ms")[0])
    assert said == pytest.approx(1e3 * late_s, abs=8.0)


@pytest.mark.study
def test_a_channel_that_is_late_and_nothing_else_keeps_its_name():
    found = diagnose(fly(Setup(maneuvers=6, skew={"q": 0.05}, seed=52)), Aircraft())
    assert (found.verdict, found.causes[0].effect) == ("effect", "pitch_rate_skew")
