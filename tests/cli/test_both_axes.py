"""``advisor gap --axis both``: one answer of both axes."""

import json
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest
from click.testing import CliRunner, Result

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import gap as reading
from advisor.analysis.axis_flown import SideCompared
from advisor.cli import axis_gap
from advisor.cli import group as cli
from advisor.cli.group import advisor
from advisor.simulators.compare import Compared
from advisor.words.problems import UnusableInputError
from tests.gap.axis.test_diagnosis import FOUND
from tests.gap.test_report_screen import diagnosis


def refuse(*_: object, **__: object) -> Any:
    raise UnusableInputError("no_accepted", "No manoeuvre is accepted.", "Fly.")


@pytest.fixture
def axes(monkeypatch: pytest.MonkeyPatch) -> None:
    """Replace the diagnoses of both axes by hand-made ones."""
    pitch = Compared(diagnosis(verdict="effect"), Aircraft())
    side = replace(FOUND, verdict="parameters", sentence="L_p is too small.")
    compared = SideCompared(side, SimpleNamespace(), Aircraft())  # type: ignore[arg-type]
    monkeypatch.setattr(reading, "compare_logs", lambda *_: pitch)
    monkeypatch.setattr(axis_gap, "read_whole", lambda *_, **__: SimpleNamespace(state=None))
    monkeypatch.setattr(axis_gap, "compare_side_flown", lambda *_, **__: compared)


def gap(*options: str) -> Result:
    return CliRunner().invoke(advisor, ["gap", "flight.tlog", "--axis", "both", *options])


@pytest.mark.usefixtures("axes")
def test_the_document_has_the_keys_of_pitch_and_those_of_roll_and_yaw_under_lateral():
    document = json.loads(gap("--json").stdout)
    assert document["verdict"] == "effect"
    assert document["lateral"]["verdict"] == "parameters"
    assert document["usable"]


@pytest.mark.usefixtures("axes")
def test_the_text_of_pitch_is_first_and_that_of_roll_and_yaw_has_its_heading():
    shown = gap().stdout
    assert 0 < shown.index("Next:") < shown.index("\nRoll and yaw\n") < shown.index("L_p is too small.")


@pytest.mark.usefixtures("axes")
@pytest.mark.parametrize(
    ("room", "name", "heading"),
    [(axis_gap, "compare_side_flown", "Roll and yaw"), (reading, "compare_logs", "Pitch")],
)
def test_an_axis_without_an_answer_gives_its_reason_next_to_the_other_axis(monkeypatch, room, name, heading):
    monkeypatch.setattr(room, name, refuse)
    told = gap("--json")
    assert told.exit_code == 0
    assert f"{heading}: No manoeuvre is accepted" in told.stderr
    assert [one["code"] for one in json.loads(told.stdout)["problems"]] == ["no_accepted"]


@pytest.mark.usefixtures("axes")
def test_without_an_answer_of_any_axis_the_log_cannot_be_used(monkeypatch, capsys):
    monkeypatch.setattr(reading, "compare_logs", refuse)
    monkeypatch.setattr(axis_gap, "compare_side_flown", refuse)
    monkeypatch.setattr("sys.argv", ["advisor", "gap", "flight.tlog", "--axis", "both", "--json"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    document = json.loads(capsys.readouterr().out)
    assert ended.value.code == 3
    assert not document["usable"]
    assert len(document["problems"]) == 2
