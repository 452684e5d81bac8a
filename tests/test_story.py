"""The story of a flight: no word is taken back in silence, and no sentence names what is not there."""

from dataclasses import replace
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from tests.flights import SHIPPED, TWO, recorded
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
    story = story_of(recorded("uav", 1.0, maneuvers=TWO), Aircraft())
    assert len({one.face for one in story.said}) == 2
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


@pytest.mark.study
@pytest.mark.parametrize("log", LONG, ids=lambda log: log.stem)
def test_a_long_flight_tells_a_story_without_a_fault(log: Path) -> None:
    if not log.exists():
        pytest.skip(f"{log.name} is not here")
    file = log.with_suffix(".yaml")
    assert list(faults(story_of(log, load_aircraft(file) if file.exists() else Aircraft()))) == []
