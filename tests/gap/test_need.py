"""Reasons why a flight cannot show an effect, with the channel or the manoeuvre to add."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.distinguish import need_of
from advisor.gap.records.prepare import prepare
from tests.gap.generator import Setup, fly

PLANE = Aircraft(reference_airspeed_m_s=22.0)


def flown_with(channel, reading):
    """Return two manoeuvres with a channel that always reads one value, or is absent (None)."""
    maneuvers = fly(Setup(maneuvers=2, heights_m=(80.0, 80.0), thrust_amplitude=0.1))
    return prepare([replace(m, channels=_altered(m.channels, channel, reading)) for m in maneuvers], PLANE)


def _altered(channels, name, reading):
    kept = {key: c for key, c in channels.items() if key != name}
    if reading is None:
        return kept
    return {**kept, name: replace(channels[name], y=np.full(len(channels[name]), reading))}


@pytest.mark.parametrize(
    ("effect", "channel", "reading", "because", "add"),
    [
        ("airspeed_variation", "airspeed", 22.0, "the air speed was constant", "fly at two air speeds"),
        ("airspeed_variation", "airspeed", 0.0, "reads almost zero", "check the air speed sensor"),
        ("airspeed_variation", "airspeed", None, "no air speed", "VFR_HUD at 10 Hz"),
        ("thrust_moment", "throttle", 0.4, "the throttle did not move", "fly at two air speeds"),
        ("thrust_moment", "throttle", None, "no throttle", "VFR_HUD at 10 Hz"),
        ("ground_effect", "height", 80.0, "the height hardly varied", "fly low and high"),
        ("ground_effect", "height", None, "no height", "range finder"),
    ],
)
def test_a_channel_that_did_not_vary_is_told_from_one_that_was_not_recorded(
    effect, channel, reading, because, add
):
    need = need_of(effect, flown_with(channel, reading))
    assert because in need.because
    assert add in need.add
