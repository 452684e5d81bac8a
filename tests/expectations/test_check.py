"""Outcomes of expectations, from a hand-made flight."""

from dataclasses import replace
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.expectations.check import check, junit
from advisor.expectations.draft import draft
from advisor.expectations.flown import Flown, Measured
from advisor.expectations.read import Expectations, Near, mode_of, read_expectations
from advisor.model.axes.lateral import Trim
from advisor.model.mil_f_8785c import LevelFound
from advisor.words.problems import Problem

STOPPED = SimpleNamespace(decision="stop", stopped_at=5)
GOING_ON = SimpleNamespace(decision="continue", stopped_at=3)
FLOWN = Flown(
    accepted={"pitch": 5, "lateral": 2},
    tests={"pitch": STOPPED, "lateral": GOING_ON},  # type: ignore[dict-item]
    derivatives={"M_alpha": Measured(-50.0, 2.0), "M_q": Measured(-4.0, 0.1),
                 "L_p": Measured(reason="not flown")},
    modes={"short_period_omega": Measured(9.0, 0.1)},
    levels={"pitch": (LevelFound("B", 2, 1, 2),), "lateral": ()},
    pauses_s={"alpha": 0.06},
    alarms=("the clock jumped",),
    gap={"pitch": Measured(2.5)},
)  # fmt: skip


def outcomes(
    aircraft: Aircraft | None = None, other: Flown | None = None, **sections: object
) -> dict[str, bool]:
    expected = Expectations(**sections)  # type: ignore[arg-type]
    return {one.name: one.holds for one in check(expected, FLOWN, aircraft or Aircraft(), other)}


def test_as_many_accepted_manoeuvres_as_asked_are_enough():
    assert outcomes(accepted={"pitch": 5, "lateral": 3}) == {
        "accepted.pitch": True,
        "accepted.lateral": False,
    }


def test_a_test_is_complete_by_a_manoeuvre_only_if_it_is_complete_at_the_end():
    told = outcomes(complete={"pitch": 5, "lateral": 5})
    assert told == {"complete.pitch": True, "complete.lateral": False}


def test_a_test_that_is_complete_too_late_does_not_hold():
    assert outcomes(complete={"pitch": 4}) == {"complete.pitch": False}


@pytest.mark.parametrize(
    ("near", "holds"),
    [
        (Near(value=-52.0, within=2.0), True),
        (Near(value=-52.1, within=2.0), False),
        (Near(value=-52.0, within_percent=3.0), False),
        (Near(value=-52.0, within=2.0, known_to=4.0), True),
        (Near(value=-52.0, within=2.0, known_to=3.9), False),
        (Near(origin="model", within_percent=5.0), True),
        (Near(origin="model", within_percent=3.0), False),
    ],
)  # fmt: skip
def test_a_derivative_holds_within_its_tolerance_and_known_well_enough(near, holds):
    aircraft = Aircraft(model={"M_alpha": -48.0})
    assert outcomes(aircraft, derivatives={"M_alpha": near}) == {"derivatives.M_alpha": holds}


def test_a_derivative_that_the_flight_does_not_show_does_not_hold_and_says_why():
    (told,) = check(Expectations(derivatives={"L_p": Near(value=-4.0, within=9.0)}), FLOWN, Aircraft())
    assert (told.holds, told.found) == (False, "not flown")


def test_a_derivative_is_compared_with_that_of_another_log():
    near = {"M_q": Near(origin="log", within=0.5)}
    assert outcomes(other=FLOWN, derivatives=near) == {"derivatives.M_q": True}


def test_a_mode_is_compared_with_that_of_the_files_model():
    aircraft = Aircraft(model={"Z_alpha": -8.0, "M_alpha": -49.0, "M_q": -4.0})
    near = Near(origin="model", within=0.01)
    assert outcomes(aircraft, modes={"short_period_omega": near}) == {"modes.short_period_omega": True}


def test_a_level_is_that_of_the_estimate_and_a_category_without_a_level_does_not_hold():
    told = outcomes(levels={"pitch": {"B": 2, "A": 3}, "lateral": {"B": 3}})
    assert told == {"levels.pitch.B": True, "levels.pitch.A": False, "levels.lateral.B": False}


def test_gap_pause_and_alarms_hold_up_to_their_limits():
    asked = {"gap": {"pitch": 2.5}, "longest_pause_s": {"alpha": 0.06, "beta": 1.0}, "alarms": 1}
    told = outcomes(**asked)
    assert told == {
        "gap.pitch": True, "longest_pause_s.alpha": True, "longest_pause_s.beta": False, "alarms": True
    }  # fmt: skip


def test_an_alarm_too_many_is_told():
    (told,) = check(Expectations(alarms=0), FLOWN, Aircraft())
    assert (told.holds, told.found) == (False, "1: the clock jumped")


def test_a_model_is_compared_at_the_air_speed_of_the_flight():
    flown = replace(FLOWN, airspeeds_m_s={"pitch": 22.0}, true_over_read=1.1)
    near = {"M_alpha": Near(origin="model", within=1.0), "M_q": Near(origin="model", within=0.1)}
    model = {"M_alpha": -50.0 * 4.0, "M_q": -4.0 * 2.0}
    for reference, holds in ((40.0, True), (20.0, False), (None, False)):
        aircraft = Aircraft(model=model, reference_airspeed_m_s=reference)
        outcomes = check(Expectations(derivatives=near), flown, aircraft)
        assert [one.holds for one in outcomes] == [holds, holds]


def test_another_log_is_compared_at_the_air_speed_of_the_flight():
    flown = replace(FLOWN, airspeeds_m_s={"pitch": 22.0})
    other = replace(FLOWN, airspeeds_m_s={"pitch": 44.0}, derivatives={"M_alpha": Measured(-200.0, 2.0)})
    near = {"M_alpha": Near(origin="log", within=1.0)}
    (outcome,) = check(Expectations(derivatives=near), flown, Aircraft(), other)
    assert outcome.holds


@pytest.mark.parametrize(
    ("mode", "value"), [("dutch_roll_omega", 2.0), ("dutch_roll_zeta", 0.1), ("roll_time_constant", 0.25)]
)
def test_the_modes_of_a_model_without_coupling_are_those_of_its_derivatives(mode, value):
    model = {"Y_beta": -0.2, "L_beta": 0.0, "L_p": -4.0, "L_r": 0.0, "N_beta": 3.96, "N_p": 0.0, "N_r": -0.2}
    assert mode_of(model, mode, Trim(1e9)) == pytest.approx(value, rel=1e-6)


def test_a_drafted_file_holds_for_its_own_flight(tmp_path):
    file = tmp_path / "drafted.yaml"
    file.write_text(draft(FLOWN, "a.tlog"), encoding="utf-8")
    expected = read_expectations(file, Aircraft())
    assert set(expected.derivatives) == {"M_alpha", "M_q"}
    assert all(one.holds for one in check(expected, FLOWN, Aircraft()))


def test_a_drafted_tolerance_is_wider_than_the_error_of_the_difference_of_two_flights(tmp_path):
    file = tmp_path / "drafted.yaml"
    file.write_text(draft(FLOWN, "a.tlog"), encoding="utf-8")
    within = read_expectations(file, Aircraft()).derivatives["M_alpha"].within
    # Three numbers hold together in 95 % where each holds in 98.3 %, which is 2.39 standard deviations.
    assert within == pytest.approx(2.39 * 2.0**0.5 * 2.0, abs=0.2)


def test_the_report_has_a_failure_for_what_does_not_hold():
    asked = Expectations(accepted={"pitch": 5, "lateral": 3})
    suite = ElementTree.fromstring(junit("a.tlog", "b.yaml", check(asked, FLOWN, Aircraft())))[0]
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("2", "1", "0")
    assert [case.find("failure") is not None for case in suite] == [False, True]


def test_the_report_of_an_unusable_log_is_one_error():
    suite = ElementTree.fromstring(junit("a.tlog", "b.yaml", [], [Problem("empty", "It is empty.", "Fly.")]))[
        0
    ]
    (error,) = suite.iter("error")
    assert (suite.get("tests"), error.get("type"), error.text) == ("1", "empty", "It is empty. Fly.")
