"""The screens outlive the process that estimates."""

import os
import signal

from advisor.campaign.hand_decisions import ByHand
from advisor.session.conducting import SessionReport
from advisor.session.remote import ConductorTask, RemoteConductor
from tests.tui import elsewhere


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
