"""The story of a flight: no word is taken back in silence, and no sentence names what is not there."""

from dataclasses import replace
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap import as_in_tables
from benchmarks.lateral_gap import scenario_of
from sim.lateral import lateral_flight
from sim.record import record
from sim.scenario import Scenario
from tests.conftest import Advisor
from tests.flights import FOUR, SHIPPED, TWO, recorded
from tests.story import Said, Story, faults, story_of
from tests.tui import flights

SHARED = Path(__file__).parents[2] / "shared" / "flights"
LONG = (
    SHIPPED / "bundled-demo.tlog", SHIPPED / "arduplane-calm.tlog", SHARED / "jet-vane.tlog",
    SHARED / "glider.tlog", SHARED / "lateral-cub.tlog", SHARED / "lateral-jet.tlog",
)  # fmt: skip


def told(*texts, face="text", state=None, aircraft=flights.AIRCRAFT):
    said = [Said(float(k), face, text) for k, text in enumerate(texts)]
    return list(faults(Story(said, state or flights.state(3), aircraft)))


def test_a_flight_of_two_manoeuvres_tells_a_story_without_a_fault() -> None:
    story = story_of(Aircraft(), recorded("uav", 1.0, maneuvers=TWO))
    assert {one.face for one in story.said} == {"text", "pilot", "analyze"}
    assert list(faults(story)) == []


def test_a_verdict_that_changes_without_a_line_is_a_fault():
    accepted, rejected = (f" 5   1:20.0  3-2-1-1          {mark} said" for mark in "✓✗")
    assert "changes without a line" in told(accepted, rejected)[0]
    assert told(accepted, accepted) == []


def test_a_stop_that_is_taken_back_without_its_reason_is_a_fault():
    assert "is taken back" in told("TEST COMPLETE: all.", "CONTINUE: one more input.", face="pilot")[0]
    assert told("TEST COMPLETE: all.", "CONTINUE: the stop is denied by later data.", face="pilot") == []


def test_a_simulator_or_a_manoeuvre_that_is_not_there_is_a_fault():
    bare = replace(flights.AIRCRAFT, model={}, simulator=None)
    assert "no simulator is there" in told("The simulator is too quick.", aircraft=bare)[0]
    assert "there is no manoeuvre 9" in told("stop since: after manoeuvre 9")[0]


def test_a_printed_command_that_the_program_does_not_take_is_a_fault():
    assert "--nonsense" in told("advisor gap a.tlog --nonsense")[0]
    assert told("advisor gap a.tlog --axis both") == []


def test_a_forecast_that_vanishes_or_rises_without_a_reason_is_a_fault():
    verdict, four = (
        " 5   1:20.0  3-2-1-1          ✓ said",
        "    next: it; about 3 more, 9 times in 10 at most 4",
    )
    assert "vanishes" in told(verdict, four, verdict, "    next: it")[0]
    assert "rises without a reason" in told(verdict, four, verdict, four)[0]
    assert told(verdict, four, verdict, f"{four} (the criterion rose from 3 to 4 %)") == []
    assert told(verdict, four, verdict, four.replace("most 4", "most 3")) == []


def test_two_lags_of_one_servo_are_a_fault():
    one = "note: The servo's lag is 0.143 ± 0.019 s. For the aircraft file: elevator: {lag_s: 0.143}"
    assert told(one, "[1] The servo's lag of 0.143 s is used.", face="analyze") == []
    assert "2 values" in told(one, "[1] The servo's lag of 0.129 s is used.", face="analyze")[0]


def test_an_open_test_that_asks_for_nothing_is_a_fault():
    nothing = "  no further manoeuvre needed"
    assert "asks for nothing" in told("TEST COMPLETE: later data open it again", nothing, face="analyze")[0]
    assert told("■ TEST COMPLETE: all.", nothing, face="analyze") == []


@pytest.fixture
def sideways(tmp_path: Path) -> Path:
    """Return a log of the bundled aircraft's five inputs of aileron and rudder."""
    record(lateral_flight(Scenario()), tmp_path / "sideways.tlog")
    return tmp_path / "sideways.tlog"


@pytest.mark.study
def test_roll_and_yaw_in_side_gusts_tell_a_story_without_a_fault(tmp_path: Path) -> None:
    gusts = scenario_of(301199, {"side_turbulence": {"sigma_v_m_s": 0.3}})
    record(lateral_flight(gusts), tmp_path / "gusts.tlog")
    assert list(faults(story_of(Aircraft(), tmp_path / "gusts.tlog"))) == []


@pytest.mark.study
def test_a_table_of_the_samples_tells_a_story_without_a_fault(advisor: Advisor, tmp_path: Path) -> None:
    log = SHIPPED / "arduplane-calm.tlog"
    advisor("export", log, "-o", tmp_path / "calm", "--format", "csv")
    table = tmp_path / "calm" / "record_1" / "grid.csv"
    aircraft = as_in_tables(load_aircraft(log.with_suffix(".yaml")), [table])
    story = story_of(aircraft, table)
    assert len(story.state.maneuvers) > 0
    assert list(faults(story)) == []


@pytest.mark.study
def test_roll_and_yaw_alone_tell_a_story_without_a_fault(sideways: Path) -> None:
    assert list(faults(story_of(Aircraft(), sideways))) == []


@pytest.mark.study
def test_both_axes_in_one_campaign_tell_a_story_without_a_fault(sideways: Path) -> None:
    story = story_of(Aircraft(), recorded("uav", 1.0, maneuvers=FOUR), sideways)
    assert story.state.plan is not None
    assert list(faults(story)) == []


@pytest.mark.study
@pytest.mark.parametrize("log", LONG, ids=lambda log: log.stem)
def test_a_long_flight_tells_a_story_without_a_fault(log: Path) -> None:
    if not log.exists():
        pytest.skip(f"{log.name} is not here")
    file = log.with_suffix(".yaml")
    assert list(faults(story_of(load_aircraft(file) if file.exists() else Aircraft(), log))) == []
