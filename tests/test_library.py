"""The library gives what the commands give, and its page runs as it stands."""

import json
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import advisor as library
from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.aircraft.reference import PARAMETERS
from advisor.analysis import gap
from advisor.campaign.state import CampaignState
from advisor.oem.known_instruments import with_found
from advisor.report.gap_document import gap_document
from tests.conftest import Advisor
from tests.flights import SHIPPED, TWO, recorded

ROOT = Path(__file__).parents[1]
KNOWN = Aircraft(elevator=Elevator(lag_s=0.02))


@pytest.fixture(scope="module")
def flight() -> library.Flight:
    return library.read(recorded("uav", 1.0, maneuvers=TWO), KNOWN)


@pytest.mark.study
def test_the_example_of_the_page_runs_in_the_folder_of_the_project(monkeypatch, capsys):
    page = (ROOT / "docs" / "how-to" / "notebook.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    monkeypatch.chdir(ROOT)
    exec(compile(example, "docs/how-to/notebook.md", "exec"), {})
    told = capsys.readouterr().out
    assert "at 50 Hz" in told
    assert "7 3-2-1-1" in told or "7 reverse 3-2-1-1" in told
    assert "TEST COMPLETE" in told
    assert "effect [('actuator_lag'" in told


def test_every_public_name_is_there_and_documented() -> None:
    for name in library.__all__:
        if name != "__version__":
            assert getattr(library, name).__doc__


def test_the_page_names_every_public_function_and_error() -> None:
    page = (ROOT / "docs" / "reference" / "api.md").read_text(encoding="utf-8")
    assert [name for name in library.__all__ if name != "__version__" and name not in page] == []


def test_a_name_that_is_not_there_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="no attribute 'reed'"):
        library.reed  # noqa: B018


def test_importing_the_library_loads_nothing_heavy() -> None:
    program = "import sys, advisor; print(sorted({'numpy', 'scipy', 'numba', 'click'} & set(sys.modules)))"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert run.stdout == "[]\n"


@pytest.fixture(scope="module")
def judged(flight: library.Flight) -> CampaignState:
    return library.judge(flight)


@pytest.mark.usefixtures("recorded_analyses")
def test_find_gives_the_manoeuvres_that_analyze_lists(flight: library.Flight, advisor: Advisor) -> None:
    told = json.loads(advisor("analyze", flight.log, "--json").stdout)["maneuvers"]
    assert [m.span.start_s for m in library.find(flight)] == [m["start_boot_s"] for m in told]


@pytest.mark.usefixtures("recorded_analyses")
def test_judge_gives_the_numbers_of_analyze(flight, judged, advisor, tmp_path):
    aircraft = tmp_path / "aircraft.yaml"
    aircraft.write_text("elevator: {lag_s: 0.02}\n")
    told = json.loads(advisor("analyze", flight.log, "--aircraft", aircraft, "--json").stdout)
    assert [m.verdict.sentence for m in judged.maneuvers] == [m["sentence"] for m in told["maneuvers"]]
    assert judged.flight_test.sentence == told["flight_test"]["sentence"]
    assert judged.model is not None
    values = {name: judged.model.value(name) for name in PARAMETERS}
    assert values == {name: told["model"][name]["value"] for name in PARAMETERS}
    assert library.read(flight.log, aircraft).aircraft == KNOWN


def test_with_the_instruments_of_all_manoeuvres_estimate_gives_what_judge_has_for_each(flight, judged):
    assert judged.model is not None
    assert judged.model.found is not None
    as_told = with_found(flight.aircraft, judged.model.found)
    for maneuver, known in zip(library.find(flight), judged.maneuvers, strict=True):
        found = library.estimate(maneuver, as_told)
        assert isinstance(found, library.Estimate)
        assert isinstance(known.estimate, library.Estimate)
        np.testing.assert_array_equal(found.theta, known.estimate.theta)


def test_estimate_takes_several_manoeuvres_together(flight: library.Flight) -> None:
    maneuvers = library.find(flight)
    one, both = library.estimate(maneuvers[0], KNOWN), library.estimate(maneuvers, KNOWN)
    assert isinstance(one, library.Estimate)
    assert isinstance(both, library.Estimate)
    assert (len(one.fits), len(both.fits)) == (1, 2)


@pytest.mark.study
def test_diagnose_gives_the_verdict_of_gap(flight: library.Flight, advisor: Advisor, tmp_path: Path) -> None:
    aircraft = tmp_path / "aircraft.yaml"
    aircraft.write_text("elevator: {lag_s: 0.02}\n")
    run = advisor("gap", flight.log, "--aircraft", aircraft, "--json", "--out", tmp_path / "improved.yaml")
    told, found = json.loads(run.stdout), library.diagnose(flight)
    assert gap_document(found)["verdict"] == told["verdict"]
    assert [cause.effect for cause in found.causes] == [cause["effect"] for cause in told["causes"]]


def test_diagnose_compares_with_the_simulator_that_the_aircraft_file_names(flight, monkeypatch):
    asked: list[object] = []
    compared = SimpleNamespace(diagnosis="compared")
    monkeypatch.setattr(gap, "named_simulator", lambda aircraft, _: asked.append(aircraft.simulator))
    monkeypatch.setattr(gap, "compare_flown", lambda *_: compared)
    own = replace(flight, aircraft=replace(flight.aircraft, simulator="jsbsim:c172p"))
    assert library.diagnose(own) == "compared"
    assert asked == ["jsbsim:c172p"]


def test_a_log_that_cannot_be_used_is_read_with_its_problems_and_find_raises_them() -> None:
    flight = library.read(SHIPPED / "arduplane-default-rates.tlog")
    assert "rate" in {problem.code for problem in flight.problems}
    with pytest.raises(library.UnusableInputError, match="Hz"):
        library.find(flight)


def test_flights_read_with_two_aircraft_are_no_campaign(flight: library.Flight) -> None:
    other = library.read(flight.log)
    with pytest.raises(library.ConfigurationError, match="another aircraft"):
        library.judge([flight, other])
    with pytest.raises(library.ConfigurationError, match="There is no flight"):
        library.judge([])
