"""A campaign in a process of its own says what it says in this one, and breaks off as it does here."""

import pickle
from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest

from advisor.campaign.state import HandDecision
from advisor.oem.estimate import Estimate
from advisor.session.conducting import Conducting, LinkHealth, Playback, SessionReport, changes
from advisor.session.conductor import Conductor
from advisor.session.remote import ConductorTask, RemoteConductor
from advisor.tui.app import AdvisorApp
from advisor.tui.screens.engineer import EngineerScreen
from advisor.words.problems import UnusableInputError
from tests.campaign.states import changed
from tests.tui import elsewhere, flights

GOOD = LinkHealth("good", "412 messages/s.")


def last_report(conductor: Conducting, wanted: Callable[[SessionReport], bool]) -> SessionReport:
    """Run until a report is as wanted."""
    reports: list[SessionReport] = []

    def tell(report: SessionReport) -> None:
        reports.append(report)
        if wanted(report):
            conductor.stop()

    conductor.run(tell)
    return next(report for report in reports if wanted(report))


def ended(report: SessionReport) -> bool:
    return report.health.condition == "ended"


def test_what_another_process_sends_twice_can_be_compared():
    once, again = (pickle.loads(pickle.dumps(flights.state(2))) for _ in range(2))
    assert once.maneuvers == once.maneuvers
    assert once.maneuvers != again.maneuvers
    assert once.model != again.model


def test_another_process_comes_to_the_same_bits():
    here = last_report(Conductor(elsewhere.first_manoeuvre(), elsewhere.campaign), ended)
    task = ConductorTask(elsewhere.first_manoeuvre, elsewhere.campaign)
    there = last_report(RemoteConductor(task), ended)
    assert len(here.state.maneuvers) == len(there.state.maneuvers) == 1
    for a, b in zip(here.state.maneuvers, there.state.maneuvers, strict=True):
        assert isinstance(a.estimate, Estimate)
        assert isinstance(b.estimate, Estimate)
        assert np.array_equal(a.estimate.theta, b.estimate.theta)
        assert np.array_equal(a.estimate.covariance, b.estimate.covariance)
        assert a.verdict == b.verdict
    assert here.state.flight_test == there.state.flight_test
    assert here.log == there.log


def test_changes_give_the_report_and_leave_alone_what_did_not_change():
    before = SessionReport(flights.state(3, in_the_air=True), GOOD, Playback(3.0, 60.0), ("heard",))
    newer = replace(before.state, now_s=99.0, flying=None)
    after = SessionReport(newer, GOOD, Playback(3.1, 60.0), before.log)
    told = changes(before, after).applied_to(before)
    for name in (f.name for f in fields(after) if f.name != "state"):
        assert getattr(told, name) is getattr(after, name)
    for name in (f.name for f in fields(newer)):
        assert getattr(told.state, name) is getattr(newer, name), name


def test_the_samples_of_judged_manoeuvres_are_not_sent_again():
    before = SessionReport(flights.state(5), GOOD, None, ())
    after = replace(before, state=replace(before.state, now_s=99.0))
    assert len(pickle.dumps(before)) > 100_000
    assert len(pickle.dumps(changes(before, after))) < 2_000


def test_a_further_verdict_sends_the_samples_of_no_earlier_manoeuvre():
    five, six = flights.state(5), flights.state(6)
    earlier = tuple(replace(judged, notes=("seen again",)) for judged in five.maneuvers)
    before = SessionReport(five, GOOD, None, ())
    after = SessionReport(changed(six, maneuvers=(*earlier, six.maneuvers[5])), GOOD, None, ())
    sent = pickle.dumps(changes(before, after))
    assert len(sent) < len(pickle.dumps(before)) / 2
    told = pickle.loads(sent).applied_to(before).state.maneuvers
    assert [judged.notes for judged in told] == [judged.notes for judged in after.state.maneuvers]
    assert all(mine.estimate is theirs.estimate for mine, theirs in zip(told, five.maneuvers, strict=False))


def test_decisions_by_hand_reach_the_other_process():
    conductor = RemoteConductor(ConductorTask(elsewhere.talking, elsewhere.staged))
    conductor.decide(HandDecision("exclude", "a gust", 2))
    report = last_report(conductor, lambda r: any(j.excluded_because == "a gust" for j in r.state.maneuvers))
    assert [j.excluded_because for j in report.state.maneuvers] == [None, "a gust", None]


def test_unusable_input_is_the_same_error_here():
    with pytest.raises(UnusableInputError, match="AOA_SSA arrives at 4 Hz") as caught:
        RemoteConductor(ConductorTask(elsewhere.unusable, elsewhere.staged)).run(lambda report: None)
    assert (caught.value.problem.code, caught.value.problem.fix) == ("rate", "Ask for 50 Hz.")


def test_a_fault_tells_where_it_happened():
    with pytest.raises(ZeroDivisionError, match="a fault") as caught:
        RemoteConductor(ConductorTask(elsewhere.faulty, elsewhere.staged)).run(lambda report: None)
    assert any("conductor.py" in note for note in caught.value.__notes__)


def test_a_process_that_ends_by_itself_is_told_of():
    with pytest.raises(RuntimeError, match="exit code 9"):
        RemoteConductor(ConductorTask(elsewhere.talking, elsewhere.ending)).run(lambda report: None)


async def test_keys_are_answered_while_an_estimate_runs():
    conductor = RemoteConductor(ConductorTask(elsewhere.talking, elsewhere.busy))
    app = AdvisorApp(conductor, flights.AIRCRAFT, "a source")
    async with app.run_test(size=(80, 24)) as pilot:
        await pilot.press("e")
        assert isinstance(app.screen, EngineerScreen)
        assert app.view.health.condition == "waiting"
