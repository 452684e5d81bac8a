"""An instrument that reads in proportion and has no name for it is unknown in that instrument."""

from dataclasses import replace

import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from tests.gap.generator import Setup, fly


def scaled(setup, channel, factor):
    """The flight with one channel read too high or too low."""
    flown = []
    for maneuver in fly(setup):
        read = maneuver.channels[channel]
        channels = {**maneuver.channels, channel: replace(read, y=factor * read.y)}
        flown.append(replace(maneuver, channels=channels))
    return flown


@pytest.mark.parametrize(("channel", "factor", "block"), [
    ("a_z", 0.88, "accelerometer"), ("theta", 1.1, "attitude_sensor"),
])  # fmt: skip
def test_a_scale_without_a_name_is_no_sum_of_named_effects_even_in_moving_air(channel, factor, block):
    hard = Setup(gust_std=0.12, coloured=0.5, jitter=0.004, speed_change=0.03, seed=37)
    found = diagnose(scaled(hard, channel, factor), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == block
    # An attitude that reads a tenth high has its zero off, too.
    others = {"turbulence", "gust", "alpha_bias"}
    assert not {c.effect for c in found.causes if c.present} - others


def test_where_a_named_instrument_is_off_no_other_is_suspected():
    found = diagnose(scaled(Setup(maneuvers=6, seed=38), "q", 1.08), Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["pitch_rate_scale"]
