"""Stays in flight modes between two times of a flight."""

from math import nan

from advisor.flight.vehicle.modes import stays

CHANGES = ((nan, ""), (nan, "TAKEOFF"), (10.0, "FBWA"), (40.0, "MANUAL"))


def test_a_stay_lasts_until_the_next_mode_and_the_last_one_to_the_end():
    found = list(stays(CHANGES, 2.0, 60.0))
    assert found == [(2.0, 10.0, "TAKEOFF"), (10.0, 40.0, "FBWA"), (40.0, 60.0, "MANUAL")]


def test_a_stay_outside_the_two_times_is_left_out_or_cut():
    assert list(stays(CHANGES, 20.0, 30.0)) == [(20.0, 30.0, "FBWA")]
