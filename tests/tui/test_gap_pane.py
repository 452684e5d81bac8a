"""The pane of the gap to the simulator."""

from dataclasses import replace
from pathlib import Path
from threading import Event
from types import SimpleNamespace

import pytest

from advisor.gap.alternative import Contribution
from advisor.process.parts import FailedPart
from advisor.report.gap_document import gap_document
from advisor.session.diagnosis import Document, GapTask, diagnose_elsewhere
from advisor.tui.panes import gap as pane
from advisor.tui.plot.painting import Plot
from advisor.tui.settings import Settings
from tests.analysis.test_side_traces import ANSWERED
from tests.campaign.side_builders import judged as side_judged
from tests.campaign.side_builders import state as side_state
from tests.campaign.states import changed
from tests.gap.axis.test_diagnosis import FOUND
from tests.gap.test_report_answer import DERIVATIVES
from tests.gap.test_report_screen import EVIDENCE, diagnosis
from tests.tui import flights
from tests.tui.stage import stage

ENGINEER = Settings(screen="engineer")
GAP = replace(diagnosis().gap, by_maneuver=((2, 5.0, 0.2), (3, 0.1, 0.4)))
REASONS = (Contribution("fit_gain", 2.0, "gain in the fit"), Contribution("rest", -0.5, "rest"))
DOCUMENT = {
    **gap_document(
        diagnosis(
            gap=GAP,
            derivatives=DERIVATIVES,
            although_refused=(3,),
            evidence=EVIDENCE,
            why=REASONS,
            answer=EVIDENCE[0].alternative,
            rival="actuator_lag",
        )
    ),
    "next": [{"text": "Put it there.", "command": "advisor gap x"}],
}


async def test_a_running_diagnosis_says_for_how_long_it_runs(monkeypatch, tmp_path):
    ended = Event()
    monkeypatch.setattr(pane, "diagnose_elsewhere", lambda _: ended.wait(20.0) and DOCUMENT)
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45), logs=[tmp_path / "a.tlog"]) as here:
        await here.press("d")
        await here.until(lambda: "The diagnosis of 4 manoeuvres runs for 1 s" in here.words("#gap-text"))
        ended.set()
        await here.until(lambda: "answers 30 ms too early" in here.words("#gap-text"))


async def test_choosing_the_pane_diagnoses_the_flight_and_shows_the_worst_manoeuvre(monkeypatch, tmp_path):
    asked: list[GapTask] = []
    monkeypatch.setattr(pane, "diagnose_elsewhere", lambda task: asked.append(task) or DOCUMENT)
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45), logs=[tmp_path / "a.tlog"]) as here:
        await here.press("d")
        await here.until(lambda: "answers 30 ms too early" in here.words("#gap-text"))
        said = " ".join(here.words("#gap-text").split())
        assert "M_α −44.60 → −34.30 ± 0.71 1/s²" in said
        assert "! Manoeuvre 3 is used, although advisor analyze refuses it." in said
        assert "99.9 % less" in said
        assert "1. Put it there. advisor gap x" in said
        assert "Probability: transport delay 82 % (by this flight alone 82 %), actuator lag 18 %." in said
        assert "▲ the gap is larger than before in manoeuvre 3" in said
        assert "+2.0 gain in the fit" in said
        assert "+1.5 together: 4.5 to 1 for the answer" in said
        chart = here.app.screen.query_one("#gap-alpha", Plot).chart
        assert [series.name for series in chart.series] == ["measured", "before", "after"]
        await here.press("4", "d")
        assert len(asked) == 1


FAILED = FailedPart("pitch, diagnosis", "LinAlgError: Singular matrix")


@pytest.mark.parametrize(
    ("document", "part"),
    [(gap_document(None, failed=(FAILED,)), "pitch, diagnosis"), (DOCUMENT, "picture of the gap")],
    ids=["diagnosis", "pane"],
)
async def test_a_numerical_fault_is_said_on_the_pane_and_the_screens_go_on(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, document: Document, part: str
) -> None:
    def broken(*_: object) -> None:
        raise ZeroDivisionError("float division by zero")

    monkeypatch.setattr(pane, "diagnose_elsewhere", lambda _: document)
    if document is DOCUMENT:
        monkeypatch.setattr(pane, "_chart", broken)
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45), logs=[tmp_path / "a.tlog"]) as here:
        await here.press("d")
        await here.until(lambda: "ended this part" in here.words("#gap-text"))
        assert f"A fault of the advisor, not yours, ended this part: {part} (" in " ".join(
            here.words("#gap-text").split()
        )
        await here.press("1", "d")
        assert here.app.failure is None
        assert ("answers 30 ms too early" in here.words("#gap-text")) == (document is DOCUMENT)


def test_the_pane_says_the_answer_of_roll_and_yaw_where_they_alone_were_flown() -> None:
    rows = [said for _, said in pane.answer_rows(gap_document(FOUND))]
    assert rows[0].startswith("Roll and yaw. LIKELY CAUSE: ")
    assert "The real aileron has play of 0.57 deg" in rows[0]
    assert any("70 %" in said for said in rows[1:])


async def test_the_axis_that_is_shown_is_diagnosed(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    asked: list[GapTask] = []

    def answer(task: GapTask) -> Document:
        asked.append(task)
        return gap_document(ANSWERED)

    monkeypatch.setattr(pane, "diagnose_elsewhere", answer)
    alone = changed(flights.state(), maneuvers=(), lateral=side_state(side_judged(1, "aileron")))
    async with stage(alone, settings=ENGINEER, size=(140, 45), logs=[tmp_path / "a.tlog"]) as here:
        await here.press("d")
        await here.until(lambda: "Roll and yaw." in here.words("#gap-text"))
        rate = here.app.screen.query_one("#gap-alpha", Plot).chart
    assert [task.sideways for task in asked] == [True]
    assert rate.y_label == "p [deg/s]"
    assert [series.name for series in rate.series] == ["measured", "before", "after"]


async def test_without_a_log_the_pane_says_what_to_run_afterwards() -> None:
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45)) as here:
        await here.press("d")
        await here.until(lambda: "Nothing is recorded here" in here.words("#gap-text"))


def test_the_other_process_gives_a_document_also_of_a_log_that_does_not_exist(tmp_path: Path) -> None:
    found = diagnose_elsewhere(GapTask((tmp_path / "none.tlog",), flights.AIRCRAFT))
    assert found["schema"] == "advisor.gap/1"
    assert not found["usable"]
    assert found["problems"]


def test_the_commands_of_the_steps_name_the_aircraft_file(monkeypatch: pytest.MonkeyPatch) -> None:
    compared = SimpleNamespace(diagnosis=diagnosis(gap=GAP))
    monkeypatch.setattr("advisor.analysis.gap.compare_logs", lambda *_, **__: compared)
    task = GapTask((Path("flight.tlog"),), flights.AIRCRAFT, Path("mine.yaml"))
    assert "--aircraft mine.yaml" in task.done()["next"][0]["command"]
