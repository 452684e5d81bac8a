"""The messages of `advisor gap` about its call: mistakes before any work, and omissions after it."""

import os
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.reference import PARAMETERS
from advisor.analysis import gap as reading
from advisor.analysis.gap_flights import maneuvers_of
from advisor.cli import group as cli
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.result import Diagnosis
from advisor.simulators.compare import Compared
from tests.flights import TWO, recorded
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly
from tests.gap.test_report_screen import diagnosis


def said(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: object) -> tuple:
    """Return the exit code and what stands on stderr."""
    monkeypatch.setattr("sys.argv", ["advisor", "gap", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    return ended.value.code, capsys.readouterr().err


@pytest.mark.parametrize(
    ("out", "sentence"),
    [
        ("nowhere/x.yaml", "there is no folder"),
        ("a-file/x.yaml", "there is no folder"),
        (".", "is a folder; name a file in it"),
    ],
)
def test_a_place_that_cannot_be_written_is_refused_before_the_log_is_read(
    capsys, monkeypatch, tmp_path, out, sentence
):
    (tmp_path / "a-file").write_text("")
    code, error = said(capsys, monkeypatch, tmp_path / "missing.tlog", "--out", tmp_path / out)
    assert code == 2
    assert sentence in error
    assert error.count("\n") == 1


def test_a_folder_without_permission_is_refused_before_the_log_is_read(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(os, "access", lambda *_: False)
    code, error = said(capsys, monkeypatch, "missing.tlog", "--out", "better.yaml")
    assert code == 2
    assert "cannot be written to" in error


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (("--out", "a.yaml"), "is the aircraft file itself"),
        (("--export", "ardupilot:my-jet.json"), "takes -jet in my-jet.json for one of its frames"),
        (("--export", "ardupilot:plane.json"), "give them under reference: in the aircraft file"),
        (("--prove", "nowhere.tlog"), "cannot find the log nowhere.tlog"),
    ],
)
def test_files_of_roll_and_yaw_are_ordered_as_those_of_pitch(
    capsys, monkeypatch, tmp_path, arguments, sentence
):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.yaml").write_text("name: mine\n")
    code, error = said(
        capsys, monkeypatch, "flight.tlog", "--aircraft", "a.yaml", "--axis", "lateral", *arguments
    )
    assert code == 2
    assert sentence in error


def test_the_improved_simulator_is_not_written_over_the_aircraft_file(capsys, monkeypatch, tmp_path):
    path = tmp_path / "aircraft.yaml"
    path.write_text("name: mine\n")
    code, error = said(capsys, monkeypatch, "flight.tlog", "--aircraft", path, "--out", path)
    assert code == 2
    assert "is the aircraft file itself" in error


@pytest.mark.parametrize("verdict", ["none", "unknown"])
def test_where_there_is_nothing_to_improve_it_says_that_no_file_was_written(
    capsys, monkeypatch, tmp_path, verdict
):
    found: Diagnosis = diagnosis(verdict=verdict)
    monkeypatch.setattr(reading, "compare_logs", lambda *_: Compared(found, Aircraft()))
    out: Path = tmp_path / "better.yaml"
    code, error = said(capsys, monkeypatch, "flight.tlog", "--out", out)
    assert code == 0
    assert "better.yaml was not written" in error
    assert not out.exists()


def test_without_an_order_no_file_is_written_and_the_command_that_would_is_said(
    capsys, monkeypatch, tmp_path
):
    found: Diagnosis = diagnosis(verdict="effect")
    monkeypatch.setattr(reading, "compare_logs", lambda *_: Compared(found, Aircraft()))
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("sys.argv", ["advisor", "gap", "flight.tlog"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 0
    assert "--out aircraft-with-" in " ".join(capsys.readouterr().out.split())
    assert not list(tmp_path.iterdir())


def test_a_log_that_is_given_twice_counts_once_and_a_note_says_so(monkeypatch):
    judged: list[Maneuver] = []

    def noted(maneuvers: list[Maneuver], *_: object) -> Compared:
        judged.extend(maneuvers)
        return Compared(diagnosis(notes=("The command was held.",)), Aircraft())

    monkeypatch.setattr(reading, "compare_to_file", noted)
    log = recorded("uav", 1.0, maneuvers=TWO)
    once = maneuvers_of([log], Aircraft()).maneuvers
    found = reading.compare_logs([log, log], Aircraft()).diagnosis
    assert [m.number for m in judged] == [m.number for m in once]
    assert found.notes[0].startswith(f"{len(once)} of {2 * len(once)} manoeuvres are recorded twice")


def test_two_flights_of_the_same_plan_both_count():
    flights = [recorded("uav", 1.0, seed, TWO) for seed in (11, 12)]
    once = maneuvers_of(flights[:1], Aircraft()).maneuvers
    both = maneuvers_of(flights, Aircraft()).maneuvers
    assert len(both) == 2 * len(once)
    # A second log begins its clock anew; here it runs on, so that what drifts does so in order of flying.
    starts = [m.span.start_s for m in both]
    assert starts == sorted(starts)
    assert both[-1].span.record_from_s <= both[-1].channels["q"].t[0] < both[-1].span.end_s


@pytest.mark.study
def test_more_manoeuvres_to_keep_out_than_there_are_and_an_unusual_elevator_are_noted():
    canard = dict(zip(PARAMETERS, (0.04, -4.3, -0.03, -0.28, 0.0, -37.0, -4.8, 52.0), strict=True))
    notes = diagnose(fly(Setup(maneuvers=3)), Aircraft(model=canard), holdout=3).notes
    assert notes[0] == (
        "3 manoeuvres cannot be held out of 3: each was held out in turn instead. Give --holdout 2 at most."
    )
    assert any("M_delta_e is 52, above zero" in note for note in notes)


@pytest.mark.study
def test_what_can_be_kept_out_needs_no_note():
    notes = diagnose(fly(Setup(maneuvers=3)), Aircraft(), holdout=2).notes
    assert not any("held out" in note for note in notes)
