"""Stop or continue, from a hand-made criterion of any axis."""

from dataclasses import replace

import pytest

from advisor.decision.change import Change
from advisor.decision.history import Heard
from advisor.decision.stopping import ENOUGH, Criterion, concluded
from advisor.decision.verdict import FlightTestVerdict, NextInput, Remaining, RuleProgress, crew_plan

CHANGED = Change(2, confirmed=True, moved=(), looks_like="", sentence="M_alpha has changed.")


def criterion(holds, stopped_at=None, flown=4, usable=(0, 1, 2, 3), remaining=None):
    """Return a criterion at 80 % of its tolerance, or at 120 %."""
    now = 80.0 if holds else 120.0
    progress = RuleProgress(stopped_at, (None,) * flown, 100.0, now_percent=now, holds=holds)
    said = NextInput("next: one more", remaining)
    by_rule = {"information": progress}
    return Criterion("information", by_rule, lambda stop: f"stop is {stop}", lambda: said, flown, set(usable))


def heard(stops, usable=(0, 1), remaining=None):
    """Return what was heard after one manoeuvre."""
    return Heard(
        {"information": 80.0}, frozenset({"information"} if stops else ()), frozenset(usable), remaining
    )


def test_a_criterion_that_holds_stops_the_test_and_asks_for_nothing_more():
    verdict = concluded(criterion(True, stopped_at=4), [])
    assert verdict.decision == "stop"
    assert verdict.sentence == "stop is True"
    assert verdict.next.advice == "no further manoeuvre needed"
    assert verdict.next.remaining == Remaining(0, 0)


def test_a_criterion_that_does_not_hold_continues_with_the_input_of_its_axis():
    verdict = concluded(criterion(False), [])
    assert (verdict.decision, verdict.sentence) == ("continue", "stop is False")
    assert verdict.next.advice == "next: one more"


def test_a_stop_that_was_heard_stays_while_its_manoeuvres_are_usable():
    before = [heard(False), heard(True), heard(False)]
    stays = concluded(criterion(False, stopped_at=2), before)
    assert stays.decision == "stop"
    assert stays.sentence == "TEST COMPLETE since manoeuvre 2; later data open it again: stop is False"
    assert stays.next.advice == "next: one more"
    ended = concluded(criterion(False, stopped_at=2, usable=(0, 2, 3)), before)
    assert ended.decision == "continue"
    assert ended.sentence == (
        "CONTINUE: a manoeuvre behind the stop after manoeuvre 2 does not count any more; stop is False"
    )


def test_a_stop_whose_criterion_is_not_computed_again_says_that_nothing_changed():
    kept = criterion(False, stopped_at=2)
    untold = replace(kept.chosen, now_percent=None)
    stays = concluded(replace(kept, by_rule={"information": untold}), [heard(False), heard(True)])
    assert stays.sentence == "TEST COMPLETE since manoeuvre 2: no change of the aircraft was found since."
    assert stays.next.advice == "no further manoeuvre needed"


def test_a_stop_that_later_data_deny_is_said_as_that_with_what_is_open():
    denied = concluded(criterion(False, stopped_at=2), [])
    assert (
        denied.sentence == "CONTINUE: later manoeuvres contradict the stop after manoeuvre 2; stop is False"
    )


def test_a_confirmed_change_of_the_aircraft_ends_a_stop_that_was_heard():
    before = [heard(False), heard(True), heard(False)]
    verdict = concluded(criterion(False, stopped_at=2), before, CHANGED)
    assert (verdict.decision, verdict.sentence) == ("continue", "CONTINUE: M_alpha has changed.")
    suspected = replace(CHANGED, confirmed=False)
    assert concluded(criterion(False, stopped_at=2), before, suspected).decision == "stop"


@pytest.mark.parametrize(("p90", "why"), [(5, ""), (9, "the criterion rose from 80 to 120 %")])
def test_a_forecast_narrows_or_says_why_not(p90, why):
    before = [heard(False), heard(False), heard(False, remaining=Remaining(4, 6))]
    said = concluded(criterion(False, remaining=Remaining(3, p90)), before).next.remaining
    assert said == Remaining(3, p90, why)


def test_a_forecast_is_never_empty_after_there_was_one():
    before = [heard(False), heard(False), heard(False, remaining=Remaining(4, 6))]
    assert concluded(criterion(False), before).next.remaining.median == 3


def test_a_change_is_said_only_where_it_ends_a_stop():
    never = concluded(criterion(False), [heard(False)] * 3, CHANGED)
    ended = concluded(criterion(False, stopped_at=2), [heard(False), heard(True), heard(True)], CHANGED)
    assert never.sentence == "stop is False"
    assert ended.sentence == "CONTINUE: M_alpha has changed."


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
