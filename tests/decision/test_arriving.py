"""The information of an input in the air makes the errors smaller, and says when it is enough."""

from dataclasses import replace
from functools import cache
from math import sqrt

import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.campaign import single_maneuver
from advisor.campaign.single_maneuver import ArrivingInformation
from advisor.campaign.state import LateralState
from advisor.decision.arriving import Arriving
from advisor.decision.arriving_errors import Known, arriving
from advisor.decision.verdict import FlightTestVerdict, RuleProgress
from advisor.tui.panes.live import arrived_in_words
from tests.decision.test_coupling import T, flown

NOTHING = Known(None, {})
BEFORE = dict.fromkeys(("M_alpha", "M_q", "M_delta_e", "Z_alpha"), 120.0)


@cache
def once():
    """A 3-2-1-1 and its estimate, which is that of all manoeuvres before."""
    return flown(0.5)


def errors(until_s: float):
    maneuver, estimated = once()
    return arriving(maneuver, until_s, Known(estimated, BEFORE), NOTHING).percent


def test_an_input_that_is_flown_again_leaves_the_root_of_half_of_each_variance():
    for percent in errors(13.98).values():
        assert percent == pytest.approx(120.0 / sqrt(2.0), rel=0.15)


def test_every_second_makes_each_error_smaller():
    courses = [errors(until_s) for until_s in (4.0, 5.0, 6.0, 8.0)]
    for name in BEFORE:
        course = [percent[name] for percent in courses]
        assert course == sorted(course, reverse=True)
        assert course[-1] < course[0] < 120.0


def test_it_is_enough_when_each_derivative_is_within_its_tolerance():
    assert Arriving(60.0, {"M_alpha": 99.0, "M_q": 100.0}).is_enough
    assert not Arriving(60.0, {"M_alpha": 99.0, "M_q": 101.0}).is_enough
    assert not Arriving(60.0, {}).is_enough


def test_before_any_estimate_nothing_is_said():
    assert arriving(once()[0], 8.0, Known(None, BEFORE), NOTHING).percent == {}


def test_an_unknown_derivative_has_no_error_and_is_never_enough():
    maneuver, estimated = once()
    before = {**dict.fromkeys(BEFORE, 1.0), "M_q": None}
    found = arriving(maneuver, 8.0, Known(estimated, before), NOTHING)
    assert (max(found.percent.values()) < 1.0, found.unknown) == (True, ("M_q",))
    assert not found.is_enough


def followed(information, end_s: float, lateral=None):
    """Follow the first input of a flight test up to a time."""
    so_far = replace(once()[0], span=replace(once()[0].span, end_s=end_s))
    nothing = FlightTestVerdict("information", "continue", "", None, 100.0, None, {})
    return information.follow(so_far, None, nothing, lateral)


def test_the_first_input_has_the_errors_of_its_own_data():
    information = ArrivingInformation(Aircraft(elevator=Elevator(lag_s=0.0)))
    courses = [found.percent for s in (6, 13) if (found := followed(information, s)) is not None]
    assert {*courses[-1]} == {*BEFORE}
    assert courses[-1]["M_delta_e"] < courses[0]["M_delta_e"]


def test_the_first_input_has_one_error_whoever_looks_how_often():
    aircraft = Aircraft(elevator=Elevator(lag_s=0.0))
    often = ArrivingInformation(aircraft)
    for end_s in (4, 8, 12):
        followed(often, float(end_s))
    assert followed(often, 13.0) == followed(ArrivingInformation(aircraft), 13.0)


def test_an_axis_whose_controls_rest_is_not_estimated(monkeypatch):
    estimated = []
    monkeypatch.setattr(single_maneuver, "estimate_axis", lambda *_: estimated.append(1))
    information = ArrivingInformation(Aircraft(elevator=Elevator(lag_s=0.0)))
    state = LateralState((), FlightTestVerdict("information", "continue", "", None, 100.0, None, {}), None)
    found = followed(information, 13.0, state)
    assert ({*found.percent}, estimated) == ({*BEFORE}, [])


def test_samples_count_up_to_whole_seconds_whenever_somebody_looks():
    maneuver, estimated = once()
    progress = RuleProgress(None, (), 100.0, parameter_percent=BEFORE)
    test = FlightTestVerdict("information", "continue", "", None, 100.0, None, {"information": progress})
    seen = {}
    for end_s in T[T > 4.0][::21]:
        so_far = replace(maneuver, span=replace(maneuver.span, end_s=float(end_s)))
        found = ArrivingInformation(Aircraft()).follow(so_far, estimated, test, None)
        if found is not None:
            assert seen.setdefault(found.until_s, found) == found
    assert {until_s - 2.0 for until_s in seen} == set(range(2, 11))


def test_the_bars_are_full_within_the_tolerance_and_the_word_stands_above_them():
    word, bars = arrived_in_words(Arriving(60.0, {"M_alpha": 100.0, "M_q": 101.0}))
    assert word.startswith("not yet enough")
    assert bars == "  M_α ██████████  100    M_q █████████·  101"
    assert arrived_in_words(Arriving(60.0, {"M_alpha": 50.0}))[0] == "ENOUGH: let go"
    assert arrived_in_words(None) == []
