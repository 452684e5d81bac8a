"""A manoeuvre that cannot be used is left out, and says nothing of the others."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from advisor.gap.records.prepare import prepare
from advisor.gap.records.usable import usable_of
from advisor.problems import UnusableInputError
from tests.gap.generator import Setup, fly

FLOWN = fly(Setup(maneuvers=6, seed=71))


def without(maneuver, *names):
    channels = {name: c for name, c in maneuver.channels.items() if name not in names}
    return replace(maneuver, channels=channels)


def ending(maneuver, name, seconds):
    """The manoeuvre with a channel that ends so many seconds after the command's beginning."""
    channel = maneuver.channels[name]
    begun = maneuver.channels["elevator"].t[0]
    return replace(maneuver, channels={**maneuver.channels, name: channel.cut(-np.inf, begun + seconds)})


def numbers(maneuvers):
    return [m.number for m in maneuvers]


def test_a_manoeuvre_without_angle_of_attack_and_air_speed_does_not_hide_the_speed_of_the_others():
    found = prepare([*FLOWN[:5], without(FLOWN[5], "alpha", "airspeed")], Aircraft())
    assert [f.number for f in found.flights] == numbers(FLOWN[:5])
    assert found.speed_measured
    assert diagnose([*FLOWN[:5], without(FLOWN[5], "alpha", "airspeed")], Aircraft()).verdict == "none"


@pytest.mark.parametrize("seconds", [-1.0, 0.1])
def test_a_pitch_rate_that_ends_before_the_command_is_left_out(seconds):
    flown = [*FLOWN[:5], ending(FLOWN[5], "q", seconds)]
    assert numbers(usable_of(flown)) == numbers(FLOWN[:5])
    assert diagnose(flown, Aircraft()).verdict == "none"


def test_with_a_single_one_left_the_answer_is_what_to_fly():
    flown = [FLOWN[0], ending(FLOWN[1], "q", 0.1), without(FLOWN[2], "elevator")]
    with pytest.raises(UnusableInputError, match="1 usable manoeuvre in the log"):
        diagnose(flown, Aircraft())
