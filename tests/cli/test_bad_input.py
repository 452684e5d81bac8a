"""Bad input: one clear sentence, the right exit code, the document still comes, never a traceback."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats.telemetry import read_tlog
from tests.conftest import Advisor
from tests.flights import TWO, recorded


def without(log: Path, name: str, to: Path) -> Path:
    """A copy of a log in which one type of message never came."""
    from advisor.mavlink.wire.definitions import DEFINITIONS

    data, kept, at = log.read_bytes(), bytearray(), 0
    unwanted = DEFINITIONS[name].id
    while at < len(data):
        size = 8 + 12 + data[at + 9]
        if int.from_bytes(data[at + 15 : at + 18], "little") != unwanted:
            kept += data[at : at + size]
        at += size
    to.write_bytes(kept)
    return to


BAD: dict[str, tuple[Callable[[Path], object], str]] = {
    "a file that is no tlog": (lambda p: p.write_text("a note of the flight\n" * 100), "no MAVLink"),
    "a table without a surface": (lambda p: p.write_text("time,alpha,q\n0,1,2\n" * 100), "no column"),
    "an empty file": (lambda p: p.write_bytes(b""), "empty"),
    "a log without a vehicle": (
        lambda p: without(recorded("linear", 1.0, maneuvers=TWO), "HEARTBEAT", p),
        "HEARTBEAT",
    ),
    "a log without an elevator": (
        lambda p: without(recorded("linear", 1.0, maneuvers=TWO), "SERVO_OUTPUT_RAW", p),
        "elevator",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_unusable_input_is_told_in_a_sentence_with_exit_code_3(kind, advisor, tmp_path):
    make, expected = BAD[kind]
    log = tmp_path / "flight.tlog"
    make(log)
    result = advisor("analyze", log)
    assert result.returncode == 3
    assert expected in result.stderr
    assert "Traceback" not in result.stderr
    assert result.stdout == ""


@pytest.mark.parametrize("kind", BAD)
def test_with_json_the_document_still_comes_and_names_the_problem(kind, advisor, tmp_path):
    make, _ = BAD[kind]
    log = tmp_path / "flight.tlog"
    make(log)
    result = advisor("analyze", log, "--json")
    document = json.loads(result.stdout)
    assert result.returncode == 3
    assert document["usable"] is False
    assert all(set(problem) == {"code", "text", "fix"} for problem in document["problems"])
    assert document["problems"][0]["fix"]


def test_a_log_cut_off_inside_a_frame_is_used_up_to_the_cut(advisor: Advisor, tmp_path: Path) -> None:
    data = recorded("linear", 1.0, maneuvers=TWO).read_bytes()
    cut = tmp_path / "cut.tlog"
    cut.write_bytes(data[: len(data) * 3 // 5 + 5])
    result = advisor("analyze", cut, "--json")
    assert result.returncode == 0
    assert len(json.loads(result.stdout)["maneuvers"]) >= 1


def test_without_measured_angle_of_attack_it_is_derived_and_said_so(advisor: Advisor, tmp_path: Path) -> None:
    log = without(recorded("uav", 1.0, maneuvers=TWO[:1]), "AOA_SSA", tmp_path / "no-alpha.tlog")
    result = advisor("analyze", log, "--json")
    document = json.loads(result.stdout)
    assert result.returncode == 0
    assert document["log"]["channels"]["alpha"]["provenance"] == "derived"


def test_without_any_way_to_an_angle_of_attack_the_mend_is_named(advisor: Advisor, tmp_path: Path) -> None:
    log = without(recorded("uav", 1.0, maneuvers=TWO), "AOA_SSA", tmp_path / "a.tlog")
    log = without(log, "VFR_HUD", tmp_path / "b.tlog")
    result = advisor("analyze", log)
    assert result.returncode == 3
    assert "AOA_SSA" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_missing_file_is_told(advisor: Advisor, tmp_path: Path) -> None:
    result = advisor("analyze", tmp_path / "none.tlog")
    assert result.returncode == 3
    assert "none.tlog" in result.stderr


def test_an_unknown_key_in_the_aircraft_file_is_wrong_configuration(advisor: Advisor, tmp_path: Path) -> None:
    aircraft = tmp_path / "aircraft.yaml"
    aircraft.write_text("elevator: {calibrations: []}\nwings: 2\n")
    result = advisor("analyze", recorded("linear", 1.0, maneuvers=TWO), "--aircraft", aircraft)
    assert result.returncode == 2
    assert "elevator.calibrations" in result.stderr
    assert "wings" in result.stderr
    assert "Traceback" not in result.stderr


@pytest.mark.parametrize("arguments", [["analyse"], ["analyze"], ["analyze", "x.tlog", "--rule", "best"]])
def test_wrong_usage_has_exit_code_2(arguments: list[str], advisor: Advisor) -> None:
    result = advisor(*arguments)
    assert result.returncode == 2
    assert "Traceback" not in result.stderr


def test_the_damaged_copies_above_are_otherwise_whole(tmp_path: Path) -> None:
    def count(log: Path) -> dict[str, int]:
        counts: dict[str, int] = {}
        for columns in _all(log):
            counts[columns.name] = counts.get(columns.name, 0) + len(columns)
        return counts

    whole = count(recorded("uav", 1.0, maneuvers=TWO))
    less = count(without(recorded("uav", 1.0, maneuvers=TWO), "AOA_SSA", tmp_path / "a.tlog"))
    assert less == {name: n for name, n in whole.items() if name != "AOA_SSA"}


def _all(log: Path) -> list[Columns]:
    return [columns for batch in read_tlog(log) for columns in batch]
