"""The screens outlive the process that estimates."""

import os
import re
import signal
from functools import partial
from pathlib import Path

import pytest

from advisor.campaign.state import ByHand
from advisor.cli import narrator
from advisor.process import liveness
from advisor.session.conducting import SessionReport
from advisor.session.remote import ConductorTask, RemoteConductor
from advisor.tui.panes.pilot import BigWord
from tests.tui import elsewhere, flights
from tests.tui.stage import stage


@pytest.mark.study
def test_a_process_that_is_killed_is_started_again_and_comes_to_the_same_manoeuvres():
    conductor = RemoteConductor(ConductorTask(elsewhere.traced, elsewhere.campaign, kept=ByHand))
    reports: list[SessionReport] = []
    killed: list[int] = []

    def tell(report: SessionReport) -> None:
        reports.append(report)
        pid = int(report.health.sentence) if report.health.sentence.isdigit() else 0
        if len(report.state.maneuvers) == 1 and pid and not killed:
            killed.append(pid)
            os.kill(pid, signal.SIGKILL)
        if killed and len(report.state.maneuvers) == 2:
            conductor.stop()

    conductor.run(tell)
    after = reports[next(i for i, r in enumerate(reports) if "was killed by SIGKILL" in " ".join(r.log)) :]
    assert len(reports[-1].state.maneuvers) == 2
    assert min(len(report.state.maneuvers) for report in after) == 1
    assert "the estimating process was killed by SIGKILL; it is started again" in reports[-1].log


@pytest.fixture
def short_limits(monkeypatch: pytest.MonkeyPatch) -> None:
    for name, seconds in (("OLD_AFTER_S", 0.5), ("ENDED_AFTER_S", 1.5), ("_LOOK_EVERY_S", 0.1)):
        monkeypatch.setattr(liveness, name, seconds)


@pytest.mark.usefixtures("short_limits")
def test_a_process_that_hangs_is_told_of_over_the_last_report_and_then_replaced(tmp_path: Path):
    source = partial(elsewhere.Stopping, tmp_path / "stopped")
    conductor = RemoteConductor(ConductorTask(source, elsewhere.staged, kept=ByHand))
    reports: list[SessionReport] = []

    def tell(report: SessionReport) -> None:
        reports.append(report)
        if "it is started again" in " ".join(report.log) and report.health.condition == "good":
            conductor.stop()

    conductor.run(tell)
    old = [report for report in reports if report.health.condition == "stale"]
    assert re.fullmatch(r"ESTIMATOR NOT ANSWERING for \d s: the values below are old", old[0].health.alarm)
    assert len(old[0].state.maneuvers) == 3
    assert re.search(r"did not answer for \d s and was ended; it is started again", reports[-1].log[-1])


@pytest.mark.usefixtures("short_limits")
def test_text_says_as_well_that_the_estimator_hangs_and_is_replaced(tmp_path: Path):
    source = partial(elsewhere.Stopping, tmp_path / "stopped")
    warned: list[str] = []

    def warn(sentence: str) -> None:
        warned.append(sentence)
        if "started again" in sentence:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        narrator.narrate(ConductorTask(source, elsewhere.campaign, kept=ByHand), warned.append, warn)
    assert [re.sub(r"\d+ s", "N s", sentence) for sentence in warned] == [
        "ESTIMATOR NOT ANSWERING for N s: the lines above are old",
        "the estimating process did not answer for N s and was ended; it is started again",
    ]


async def test_the_pilot_reads_that_the_screen_is_old_instead_of_a_good_link():
    source = elsewhere.HandFedSource()
    fresh = SessionReport(flights.state(3), source.condition, None, ())
    source.condition = fresh.grown_old("ESTIMATOR", 7.0).health
    async with stage(flights.state(3), source=source) as here:
        await here.until(lambda: "ESTIMATOR NOT ANSWERING for 7 s" in here.words("Alarm"))
        assert "✗ NOT ANSWERING" in here.words("StatusLine")
        assert here.app.screen.query_one(BigWord).word == "WAIT"
        await here.press("e")
        assert "ESTIMATOR NOT ANSWERING" in here.words("Alarm")
