"""A simulator that a Python function makes, from the command line to the screen."""

import json
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft_file.read import load_aircraft
from advisor.cli import group as cli
from advisor.simulators.compare import compare
from advisor.simulators.specification import simulator_of
from advisor.words.problems import ConfigurationError
from tests.flights import FOUR, recorded
from tests.simulators.nonlinear import Nonlinear, flown
from tests.simulators.test_specification import nothing_read

FACTORY = "python:tests.simulators.nonlinear:make"


def said(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: object) -> tuple:
    """Return the exit code, stdout and stderr of ``advisor gap``."""
    monkeypatch.setattr("sys.argv", ["advisor", "gap", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    told = capsys.readouterr()
    return ended.value.code, told.out, told.err


@pytest.mark.study
def test_a_factory_in_a_process_of_its_own_flies_as_the_same_simulator_here():
    late = flown(Nonlinear(delay_s=0.05), maneuvers=3)
    simulator = simulator_of(FACTORY, Aircraft(), nothing_read)
    try:
        there = compare(late, simulator, Aircraft()).diagnosis
    finally:
        simulator.close()
    here = compare(late, Nonlinear(), Aircraft()).diagnosis
    assert there.causes == here.causes
    assert there.in_simulator.after == pytest.approx(here.in_simulator.after)


@pytest.mark.parametrize("named", ["python:alone", "python:a:b:c", "python:not-a-name:make"])
def test_a_factory_is_a_module_and_a_function(named):
    with pytest.raises(ConfigurationError, match="name a module and a function"):
        simulator_of(named, Aircraft(), nothing_read)


def test_a_module_that_does_not_exist_is_one_sentence_and_exit_code_2(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    code, out, err = said(
        capsys, monkeypatch, recorded("uav", 1.0, maneuvers=FOUR), "--simulator", "python:nowhere_at_all:make"
    )
    assert (code, out) == (2, "")
    assert "No module named 'nowhere_at_all'" in err


@pytest.mark.study
def test_the_command_writes_the_document_and_the_improved_aircraft_file(capsys, monkeypatch, tmp_path):
    out = tmp_path / "better.yaml"
    log: Path = recorded("uav", 1.0, maneuvers=FOUR)
    code, text, _ = said(capsys, monkeypatch, log, "--simulator", FACTORY, "--json", "--out", out)
    document = json.loads(text)
    assert code == 0
    assert document["simulator"] == "Python tests.simulators.nonlinear:make"
    assert document["shrink"]["in_simulator"]["percent"] > 90.0
    assert document["qualification"]["q"]["pass"] is True
    assert document["qualification"]["q"]["pass_before"] is False
    assert load_aircraft(out).simulator is None
    assert load_aircraft(out).model["M_alpha"] == pytest.approx(
        document["model"]["M_alpha"]["value"], rel=1e-4
    )


@pytest.mark.study
def test_the_whole_screen_says_how_far_in_the_simulator_and_which_channels_pass(
    capsys, monkeypatch, tmp_path
):
    aircraft = tmp_path / "mine.yaml"
    aircraft.write_text(f"simulator: {FACTORY}\n")
    log = recorded("uav", 1.0)
    out = tmp_path / "better.yaml"
    _, text, _ = said(capsys, monkeypatch, log, "--aircraft", aircraft, "--out", out, "--all")
    assert "in your simulator, Python tests.simulators.nonlinear:make" in text
    assert "FAIL → pass" in text
    assert "14 CFR Part 60" in text
