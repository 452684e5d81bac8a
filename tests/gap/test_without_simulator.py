"""Without a model in the aircraft file no simulator is tested, and nothing says that there is no gap."""

from dataclasses import replace
from io import StringIO

import pytest
from rich.console import Console

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.gap.diagnose import without_simulator
from advisor.gap.result import GapVerdict
from advisor.report.gap_document import gap_document, next_steps
from advisor.report.gap_screen import GapScreen
from tests.gap.test_report_screen import diagnosis


def test_a_flight_without_a_simulator_is_not_called_free_of_a_gap() -> None:
    found = without_simulator(replace(diagnosis(), verdict="none", causes=()), Aircraft())
    document = gap_document(found)
    assert document["verdict"] is None
    assert document["usable"] is True
    assert "no model to compare with" in document["sentence"]
    assert any("no complete model" in note for note in document["notes"])


def test_the_screen_says_that_no_simulator_was_given() -> None:
    console = Console(width=100, record=True, file=StringIO())
    console.print(GapScreen(without_simulator(replace(diagnosis(), verdict="none", causes=()), Aircraft())))
    shown = console.export_text()
    assert "NOTHING TO COMPARE WITH" in shown
    assert "NO GAP" not in shown


@pytest.mark.parametrize("verdict", ["effect", "unknown"])
def test_what_the_flight_shows_by_itself_stands_with_a_note(verdict: GapVerdict) -> None:
    found = without_simulator(replace(diagnosis(), verdict=verdict), Aircraft())
    assert found.verdict == verdict
    assert found.notes[0].startswith("The aircraft file holds no complete model")


def test_without_a_simulator_no_sentence_has_the_word() -> None:
    found = without_simulator(replace(diagnosis(), verdict="effect", derivatives=()), Aircraft())
    assert found.sentence.startswith("Your file states no elevator.delay_s; this flight says 0.030 ± ")
    assert "Change: elevator: {delay_s: 0.030}." in found.sentence
    steps = next_steps(found, ["a.tlog"], "mine.yaml")
    assert steps[0].text.startswith("Add to what the file states: transport delay")
    console = Console(width=100, record=True, file=StringIO())
    console.print(GapScreen(found, steps=steps))
    assert "simulator" not in console.export_text()


def test_a_value_of_the_file_stands_beside_that_of_the_flight() -> None:
    stated = Aircraft(elevator=Elevator(delay_s=0.01))
    found = without_simulator(replace(diagnosis(), verdict="effect", derivatives=()), stated)
    assert found.sentence.startswith("Your file says elevator.delay_s 0.01; this flight says 0.040 ± ")
