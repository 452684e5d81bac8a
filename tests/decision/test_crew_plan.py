"""One plan of both axes: what is done, what is open, and the input that brings most to what is open."""

from dataclasses import replace

import pytest

from advisor.decision.conclusion import ENOUGH
from advisor.decision.crew_plan import crew_plan
from advisor.decision.verdict import FlightTestVerdict, NextInput

DOUBLET = NextInput("next: aileron doublet", None)
REVERSE = NextInput("next: reverse 3-2-1-1", None)


def verdict(percent: float | None, advised: NextInput, limit: float = 100.0) -> FlightTestVerdict:
    decision = "stop" if advised is ENOUGH else "continue"
    return FlightTestVerdict("information", decision, "", percent, limit, None, next=advised)


@pytest.mark.parametrize(
    ("pitch", "side", "advised"),
    [
        (verdict(120.0, REVERSE), verdict(297.0, DOUBLET), DOUBLET),
        (verdict(300.0, REVERSE), verdict(297.0, DOUBLET), REVERSE),
        (verdict(80.0, REVERSE, limit=25.0), verdict(297.0, DOUBLET), REVERSE),
        (verdict(None, REVERSE), verdict(297.0, DOUBLET), REVERSE),
        (verdict(300.0, REVERSE), verdict(None, DOUBLET), DOUBLET),
        (verdict(20.0, ENOUGH), verdict(297.0, DOUBLET), DOUBLET),
    ],
)
def test_the_next_input_is_that_of_the_axis_that_lacks_most_of_its_own_limit(pitch, side, advised):
    assert crew_plan(pitch, side).next is advised


def test_a_plan_says_which_axis_is_complete_and_which_is_open():
    plan = crew_plan(verdict(20.0, ENOUGH), verdict(297.0, DOUBLET))
    assert (plan.done, plan.open) == (("pitch",), ("roll and yaw",))
    assert plan.sentence == "Pitch is complete, roll and yaw are open."
    assert not plan.is_complete


def test_a_plan_without_an_open_axis_is_complete_and_advises_no_input():
    plan = crew_plan(verdict(20.0, ENOUGH), verdict(40.0, ENOUGH))
    assert plan.is_complete
    assert plan.advice == "no further manoeuvre needed"


@pytest.mark.parametrize(
    ("pitch", "side", "heard"),
    [
        (verdict(120.0, REVERSE), verdict(297.0, DOUBLET), ""),
        (verdict(20.0, ENOUGH), verdict(297.0, DOUBLET), "Pitch is complete, roll and yaw are open."),
        (verdict(120.0, REVERSE), verdict(40.0, ENOUGH), "Roll and yaw are complete, pitch is open."),
        (
            verdict(20.0, ENOUGH),
            verdict(40.0, ENOUGH),
            "TEST COMPLETE: Pitch is complete, roll and yaw are complete.",
        ),
    ],
)
def test_a_ground_station_hears_test_complete_only_where_no_axis_is_open(pitch, side, heard):
    assert crew_plan(pitch, side).announced == heard


def test_an_open_axis_that_lacks_more_comes_first():
    plan = crew_plan(verdict(120.0, REVERSE), verdict(297.0, replace(DOUBLET)))
    assert plan.open == ("roll and yaw", "pitch")
