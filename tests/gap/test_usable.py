"""A manoeuvre that cannot be used is left out, and says nothing of the others."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.prepare import prepare
from advisor.gap.records.usable import condensed, usable_of
from tests.gap.generator import Setup, fly
from tests.maneuvers import without

FLOWN = fly(Setup(maneuvers=6, seed=71))


def ending(maneuver, name, seconds):
    """Return the manoeuvre with a channel that ends so many seconds after the command begins."""
    channel = maneuver.channels[name]
    begun = maneuver.channels["elevator"].t[0]
    return replace(maneuver, channels={**maneuver.channels, name: channel.cut(-np.inf, begun + seconds)})


def numbers(maneuvers):
    return [m.number for m in maneuvers]


def test_a_manoeuvre_without_angle_of_attack_and_air_speed_does_not_hide_the_speed_of_the_others():
    found = prepare([*FLOWN[:5], without(FLOWN[5], "alpha", "airspeed")], Aircraft())
    assert [f.number for f in found.flights] == numbers(FLOWN[:5])
    assert found.speed_measured


@pytest.mark.parametrize("seconds", [-1.0, 0.1])
def test_a_pitch_rate_that_ends_before_the_command_is_left_out(seconds):
    flown = [*FLOWN[:5], ending(FLOWN[5], "q", seconds)]
    assert numbers(usable_of(flown)) == numbers(FLOWN[:5])


def test_of_three_a_single_one_is_left_where_one_lacks_the_pitch_rate_and_one_the_command():
    flown = [FLOWN[0], ending(FLOWN[1], "q", 0.1), without(FLOWN[2], "elevator")]
    assert numbers(usable_of(flown)) == [FLOWN[0].number]


def test_what_comes_faster_than_it_need_is_averaged_between_neighbours_only():
    t = np.concatenate([np.arange(0.0, 0.5, 0.01), np.arange(0.6, 1.0, 0.01)])
    there, read = condensed(t, 3.0 * t)
    assert len(there) == len(t) // 2
    assert read == pytest.approx(3.0 * there)
    assert not np.any((there > 0.5) & (there < 0.6))
    slow = np.arange(0.0, 1.0, 0.02)
    assert condensed(slow, slow)[0] is slow
