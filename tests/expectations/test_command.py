"""``advisor expect`` on logs: files, exit codes and the document."""

import json
from pathlib import Path
from xml.etree import ElementTree

import pytest

from tests.conftest import Advisor
from tests.flights import SHIPPED, TWO, recorded
from tests.schemas import breaches

pytestmark = pytest.mark.usefixtures("recorded_analyses")


@pytest.fixture(scope="module")
def flight() -> Path:
    return recorded("linear", 1.0, maneuvers=TWO)


def test_a_written_file_holds_for_its_own_log(advisor: Advisor, flight, tmp_path: Path) -> None:
    file = tmp_path / "expectations.yaml"
    assert advisor("expect", flight, file, "--write").returncode == 0
    told = advisor("expect", flight, file)
    assert told.returncode == 0
    assert "every expectation holds" in told.stdout
    assert "derivatives.M_alpha" in told.stdout


def test_what_does_not_hold_ends_with_1_and_stands_in_both_reports(advisor, flight, tmp_path: Path) -> None:
    file, report = tmp_path / "expectations.yaml", tmp_path / "report.xml"
    file.write_text("accepted: {pitch: 2}\nderivatives:\n  M_alpha: {of: 3, within: 1}\n")
    told = advisor("expect", flight, file, "--junit", report, "--json")
    document = json.loads(told.stdout)
    assert told.returncode == 1
    assert breaches("expect", document) == []
    assert [one["holds"] for one in document["expectations"]] == [True, False]
    assert ElementTree.parse(report).getroot().get("failures") == "1"


def test_the_surfaces_of_a_table_are_its_columns(advisor, flight, tmp_path: Path) -> None:
    aircraft, file = tmp_path / "aircraft.yaml", tmp_path / "expectations.yaml"
    aircraft.write_text("elevator: {output: 2}\n")
    file.write_text("accepted: {pitch: 2}\n")
    assert advisor("export", flight, "-o", tmp_path / "flight", "--format", "csv").returncode == 0
    table = tmp_path / "flight" / "record_1" / "grid.csv"
    assert advisor("expect", table, file, "--aircraft", aircraft).returncode == 0


def test_an_unusable_log_ends_with_3_and_an_error_in_the_report(advisor, tmp_path: Path) -> None:
    file, report = tmp_path / "expectations.yaml", tmp_path / "report.xml"
    file.write_text("alarms: 0\n")
    told = advisor("expect", SHIPPED / "arduplane-default-rates.tlog", file, "--junit", report, "--json")
    document = json.loads(told.stdout)
    assert told.returncode == 3
    assert breaches("expect", document) == []
    assert (document["usable"], document["holds"]) == (False, None)
    assert ElementTree.parse(report).getroot().get("errors") == "1"


def test_a_wrong_file_ends_with_2_before_the_log_is_read(advisor, tmp_path: Path) -> None:
    file = tmp_path / "expectations.yaml"
    file.write_text("accepted: {pitch: none}\nalarm: 0\n")
    told = advisor("expect", tmp_path / "missing.tlog", file)
    assert told.returncode == 2
    assert "accepted.pitch: must be" in told.stderr
    assert "alarm: unknown key (did you mean alarms?)" in told.stderr


@pytest.mark.parametrize("more", [["--write", "--json"], ["--write"], ["--junit", "flight.yaml"]])
def test_no_file_of_the_user_is_replaced(advisor, flight, tmp_path: Path, monkeypatch, more) -> None:
    monkeypatch.chdir(tmp_path)
    Path("flight.yaml").write_text("alarms: 0\n")
    assert advisor("expect", flight, "flight.yaml", *more).returncode == 2
    assert Path("flight.yaml").read_text() == "alarms: 0\n"
