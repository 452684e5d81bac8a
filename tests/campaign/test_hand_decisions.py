"""Marks, exclusions and notes: on the command line, beside the log, and read again by every command."""

import json
import shutil
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Markers
from advisor.analysis.gap_flights import maneuvers_of
from advisor.analysis.marks_file import read_by_hand, write_by_hand
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import NOTHING, ByHand, JudgedManeuver, Remark
from advisor.flight.maneuvers.maneuver import Span
from advisor.flight.maneuvers.marks import Mark
from advisor.mavlink.logs.formats.telemetry import read_tlog
from advisor.mavlink.logs.logs import open_log
from sim.flight import Flight
from sim.record import record
from sim.scenario import Noise, Scenario
from tests.conftest import Advisor
from tests.flights import TWO, recorded

pytestmark = pytest.mark.usefixtures("recorded_analyses")


@pytest.fixture
def log(tmp_path: Path) -> Path:
    """Two manoeuvres of the linear aircraft in a folder of their own."""
    return Path(shutil.copy(recorded("linear", 1.0, maneuvers=TWO), tmp_path / "flight.tlog"))


def analyzed(advisor: Advisor, *arguments: object) -> dict[str, Any]:
    result = advisor("analyze", *arguments, "--json")
    assert result.returncode == 0, result.stderr
    document: dict[str, Any] = json.loads(result.stdout)
    return document


def flown(log: Path, by_hand: ByHand = NOTHING, aircraft: Aircraft | None = None) -> Campaign:
    campaign = Campaign(aircraft or Aircraft(), by_hand=by_hand)
    for batch in open_log(log):
        campaign.feed(batch)
    campaign.finish()
    return campaign


def test_a_mark_on_the_command_line_is_judged_like_any_other(advisor: Advisor, log: Path) -> None:
    found = analyzed(advisor, log)["maneuvers"][0]
    start_s, end_s = found["start_boot_s"] - 0.5, found["end_boot_s"]
    marked, other = analyzed(advisor, log, "--maneuver", f"{start_s}:{end_s}")["maneuvers"]
    assert marked["verdict"] == "accepted"
    assert marked["closed_by"] == "marked by hand"
    assert "marked by hand" in marked["cautions"]
    assert marked["input"] == found["input"]
    assert marked["record_from_boot_s"] == pytest.approx(start_s - 1.0, abs=0.03)
    assert other["closed_by"] == "mode change"


def test_a_stretch_in_which_nothing_happens_is_refused_and_says_what_is_missing(advisor, log):
    first = analyzed(advisor, log, "--maneuver", "+1:+6")["maneuvers"][0]
    assert first["closed_by"] == "marked by hand"
    assert first["verdict"] == "rejected"
    assert first["reasons"]


WRONG = {
    "12": "give START:END",
    "a:b": "give START:END",
    "+12:24": "both with +",
    "nan:24": "give START:END",
    "-3:4": "give START:END",
    "24:12": "END must be later than START",
    "12:400": "lasts 100 s at most",
}


@pytest.mark.parametrize("text", WRONG)
@pytest.mark.parametrize("command", ["analyze", "gap", "replay"])
def test_a_wrong_form_is_told_in_a_sentence_with_exit_code_2(advisor, log, command, text):
    result = advisor(command, log, f"--maneuver={text}")
    assert result.returncode == 2
    assert f"--maneuver {text}: " in result.stderr
    assert WRONG[text] in result.stderr


def test_two_marks_that_overlap_are_told_with_exit_code_2(advisor: Advisor, log: Path) -> None:
    result = advisor("analyze", log, "--maneuver", "+1:+8", "--maneuver", "+7:+9")
    assert result.returncode == 2
    assert "--maneuver +7:+9 overlaps --maneuver +1:+8" in result.stderr


def test_a_mark_in_the_file_gives_way_to_one_on_the_command_line_and_that_is_told(advisor, log):
    write_by_hand(log, ByHand(marks=(Mark(25.0, 32.0, 0),)))
    told = advisor("analyze", log, "--maneuver", "+4:+10").stdout
    assert "note: The mark from 0:25.0 to 0:32.0 is left out" in told.replace("\n", " ")


@pytest.mark.parametrize("command", ["analyze", "gap", "replay"])
def test_a_time_that_the_log_does_not_hold_is_told_with_exit_code_3(advisor: Advisor, command: str) -> None:
    log = recorded("linear", 1.0, maneuvers=TWO[:1])
    speed = ["--speed", "max"] if command == "replay" else []
    result = advisor(command, log, *speed, "--maneuver", "4000:4012")
    assert result.returncode == 3
    assert "--maneuver 4000:4012 lies outside of the log, which holds 0:20.0 to" in result.stderr
    assert "+12:+24" in result.stderr


def test_a_mark_in_one_of_several_logs_belongs_into_the_file_beside_it(advisor: Advisor, log: Path) -> None:
    result = advisor("gap", log, log, "--maneuver", "+3:+9")
    assert result.returncode == 2
    assert "LOG.maneuvers.yaml" in result.stderr


@cache
def spans() -> tuple[Span, Span]:
    """Where the two manoeuvres lie without marks."""
    campaign = flown(recorded("linear", 1.0, maneuvers=TWO))
    first, second = (judged.maneuver.span for judged in campaign.state.maneuvers)
    return first, second


def decisions() -> ByHand:
    """A mark, an exclusion and a note for the two manoeuvres."""
    first, second = spans()
    return ByHand(
        marks=(Mark(first.start_s - 0.5, first.end_s, 0),),
        excluded=(Remark(second.start_s, "a gust"),),
        notes=(Remark(first.start_s, "rough hands"),),
        remarks=(Remark(first.start_s + 1.0, "flaps"),),
    )


def test_analyze_reads_marks_exclusions_and_notes_beside_the_log(advisor: Advisor, log: Path) -> None:
    write_by_hand(log, decisions())
    document = analyzed(advisor, log)
    first, second = document["maneuvers"]
    assert first["closed_by"] == "marked by hand"
    assert first["notes"] == ["rough hands"]
    assert second["excluded_because"] == "a gust"
    assert document["estimate_from"] == [1]
    assert any(notice.endswith("mark: flaps") for notice in document["notices"])
    assert "note: rough hands" in advisor("analyze", log).stdout


def test_no_marks_leaves_them_out(advisor: Advisor, log: Path) -> None:
    write_by_hand(log, decisions())
    first, second = analyzed(advisor, log, "--no-marks")["maneuvers"]
    assert (first["closed_by"], second["excluded_because"]) == ("mode change", None)


def test_replay_reads_them(advisor: Advisor, log: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HEADLESS", "1")
    write_by_hand(log, decisions())
    told = advisor("replay", log, "--speed", "max").stdout
    assert "EXCLUDED" in told.upper()
    assert "a gust" in told


def test_the_diagnosis_reads_them_and_says_what_is_left_out(log: Path) -> None:
    write_by_hand(log, decisions())
    found = maneuvers_of([log], Aircraft(), by_hand=[read_by_hand(log)])
    assert [m.span.closed_by for m in found.maneuvers] == ["marked by hand"]
    assert "flight.tlog: manoeuvre 2 is excluded by hand: a gust." in found.notes


@pytest.mark.parametrize("command", ["analyze", "gap", "replay"])
def test_a_file_that_cannot_be_read_is_told_with_exit_code_2(advisor, log, command):
    log.with_suffix(".maneuvers.yaml").write_text("maneuvers: [", encoding="utf-8")
    result = advisor(command, log)
    assert result.returncode == 2
    assert "flight.maneuvers.yaml: not a YAML file" in result.stderr
    assert "Traceback" not in result.stderr


def test_live_reads_the_file_beside_a_new_recording(advisor: Advisor, tmp_path: Path) -> None:
    (tmp_path / "new.maneuvers.yaml").write_text("maneuvers: [", encoding="utf-8")
    result = advisor("live", "--master", "udpin:127.0.0.1:0", "--record", tmp_path / "new.tlog")
    assert result.returncode == 2
    assert "new.maneuvers.yaml" in result.stderr


def numbers(judged: JudgedManeuver) -> list[object]:
    """A manoeuvre and its verdict with every number as it is."""
    data = [(name, c.t.tobytes(), c.y.tobytes()) for name, c in judged.maneuver.channels.items()]
    estimate = getattr(judged.estimate, "theta", np.empty(0)).tobytes()
    return [judged.maneuver.number, judged.maneuver.span, judged.verdict, judged.notes, data, estimate]


def test_decisions_made_in_flight_and_read_back_from_their_file_decide_the_same(log: Path) -> None:
    begin_s, end_s = (span.start_s for span in spans())
    live, marked = Campaign(Aircraft(), informs=True), False
    for batch in read_tlog(log, chunk_bytes=20_000):
        live.feed(batch)
        now_s, marking = live.state.now_s, live.state.marking_since_s is not None
        if now_s > begin_s - 1.0 and not marked:
            live.engineer.begin_maneuver()
            marked = True
        if now_s > end_s - 5.0 and marking:
            live.engineer.end_maneuver()
            live.engineer.mark("turning back")
    live.engineer.note(1, "rough hands")
    live.engineer.exclude(2, "a gust")
    live.finish()
    write_by_hand(log, live.engineer.decided)
    replayed = flown(log, read_by_hand(log))
    assert live.state.maneuvers[0].maneuver.span.closed_by == "marked by hand"
    assert list(map(numbers, replayed.state.maneuvers)) == list(map(numbers, live.state.maneuvers))
    assert replayed.state.flight_test == live.state.flight_test
    assert replayed.engineer.decided.excluded == live.engineer.decided.excluded


def test_a_switch_and_texts_of_the_simulated_vehicle_mark_its_manoeuvres(tmp_path: Path) -> None:
    log = tmp_path / "flight.tlog"
    scenario = Scenario(
        aircraft="linear",
        noise=Noise(percent=1.0),
        maneuvers=TWO,
        rates={**Scenario().rates, "RC_CHANNELS": 10.0},
        said=("MARK ON", "MARK OFF"),
    )
    flight = Flight(scenario)
    record(flight, log)
    for markers, who in ((Markers(rc=9), "switch"), (Markers(text=("MARK ON", "MARK OFF")), "text")):
        campaign = flown(log, aircraft=Aircraft(markers=markers))
        found = [judged.maneuver.span for judged in campaign.state.maneuvers]
        assert all(span.closed_by.startswith(f"marked by a {who}") for span in found)
        assert [j.verdict.accepted for j in campaign.state.maneuvers] == [True, True]
        for span, planned in zip(found, flight.planned, strict=True):
            assert span.end_s == pytest.approx(20.0 + planned.end_s, abs=0.15)
            assert span.record_from_s == pytest.approx(20.0 + planned.manual_from_s - 1.0, abs=0.15)
