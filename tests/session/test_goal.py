"""A jump ends just before its manoeuvre, in the flight and power-on of the manoeuvre."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.session.timeline import DataBegin, Goal, Position
from advisor.session.view import view_before_first

STATE = view_before_first(Aircraft(), "x", None).state


@pytest.mark.parametrize(("flight", "boot"), [(0, 0), (1, 0)])
def test_a_later_time_of_an_earlier_flight_or_power_on_is_not_the_goal(flight: int, boot: int) -> None:
    goal = Goal(1, (1, 1, 50.0))
    assert not goal.reached(replace(STATE, flight=flight, boot=boot, now_s=300.0))
    assert goal.reached(replace(STATE, flight=1, boot=1, now_s=49.5))


def test_a_replay_begins_where_the_data_can_serve() -> None:
    assert not DataBegin().reached(replace(STATE, serves=False))
    assert DataBegin().reached(replace(STATE, serves=True))


def test_a_position_is_reached_when_the_replay_stands_there_or_beyond() -> None:
    assert not Position(30.0).reached(STATE, 29.9)
    assert Position(30.0).reached(STATE, 30.2)
