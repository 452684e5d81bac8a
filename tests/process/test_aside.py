"""Manoeuvres are judged while the stream is read, with the same verdicts as in turn."""

from threading import Event, get_ident
from time import monotonic

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.campaign.axis_campaign import ElevatorCampaign
from advisor.campaign.campaign import Campaign, ManeuverJudged
from advisor.campaign.single_maneuver import ArrivingInformation
from advisor.decision.arriving import Arriving
from advisor.mavlink.logs.logs import open_log
from advisor.process.aside import Aside
from advisor.session.timeline import Timeline
from tests.flights import TWO, recorded


def test_jobs_are_done_in_their_order_in_another_thread() -> None:
    aside: Aside[tuple[int, bool]] = Aside(in_thread=True)
    here = get_ident()
    for number in range(5):
        aside.do(lambda number=number: (number, get_ident() == here))
    aside.wait()
    assert aside.made() == [(number, False) for number in range(5)]
    assert not aside.is_pending


def test_a_job_in_a_thread_delays_nobody() -> None:
    aside: Aside[str] = Aside(in_thread=True)
    gate = Event()
    aside.do(lambda: "done" if gate.wait(60.0) else "too late")
    assert (aside.is_busy, aside.made()) == (True, [])
    gate.set()
    aside.wait()
    assert (aside.is_busy, aside.is_pending, aside.made()) == (False, True, ["done"])


def test_the_age_of_a_job_grows_until_the_job_is_done() -> None:
    aside: Aside[None] = Aside(in_thread=True)
    begun, gate = Event(), Event()

    def job() -> None:
        begun.set()
        gate.wait(60.0)

    aside.do(job)
    assert begun.wait(60.0)
    first = aside.age_s
    gate.wait(0.05)
    assert aside.age_s >= first + 0.05
    gate.set()
    aside.wait()
    assert aside.age_s == 0.0


def test_what_a_job_raises_is_raised_for_the_one_who_asks() -> None:
    aside: Aside[int] = Aside(in_thread=True)
    aside.do(lambda: 1 // 0)
    aside.wait()
    assert aside.is_pending
    with pytest.raises(ZeroDivisionError):
        aside.made()


def timeline_of_two() -> Timeline:
    """Return the messages of a flight of two manoeuvres."""
    batches = open_log(recorded("linear", 1.0, maneuvers=TWO))
    return Timeline([columns for batch in batches for columns in batch])


def flown(aside: bool) -> tuple[Campaign, list[str]]:
    """Fly two manoeuvres to the end, and return the campaign with the decisions that it told."""
    timeline = timeline_of_two()
    campaign, told = Campaign(Aircraft(), informs=True, lateral=True, aside=aside), list[str]()
    for k in range(1, int(timeline.duration_s) + 2):
        events = campaign.feed(timeline.up_to(float(k)))
        told += [event.flight_test.sentence for event in events if isinstance(event, ManeuverJudged)]
    told += [event.flight_test.sentence for event in campaign.finish() if isinstance(event, ManeuverJudged)]
    return campaign, told


def test_the_verdicts_are_those_of_a_campaign_that_waits_for_each() -> None:
    (beside, told), (waiting, told_there) = flown(aside=True), flown(aside=False)
    assert told == told_there
    for here, there in zip(beside.state.maneuvers, waiting.state.maneuvers, strict=True):
        assert here.verdict == there.verdict
        assert here.estimate.theta.tobytes() == there.estimate.theta.tobytes()
    assert beside.state.model.theta.tobytes() == waiting.state.model.theta.tobytes()


def test_the_state_goes_on_while_a_manoeuvre_is_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    gate, take = Event(), ElevatorCampaign.take

    def slowly(self: ElevatorCampaign, *arguments: object) -> None:
        assert gate.wait(60.0)
        take(self, *arguments)

    monkeypatch.setattr(ElevatorCampaign, "take", slowly)
    timeline = timeline_of_two()
    campaign = Campaign(Aircraft(), informs=True, lateral=True, aside=True)
    at_s = 0.0
    while not campaign.state.judging:
        campaign.feed(timeline.up_to(at_s := at_s + 0.5))
    first_s = campaign.state.now_s
    campaign.feed(timeline.up_to(at_s + 2.0))
    state = campaign.state
    assert (state.judging, state.maneuvers) == (True, ())
    assert state.now_s == pytest.approx(first_s + 2.0, abs=0.2)
    gate.set()
    campaign.wait()
    assert (campaign.state.judging, len(campaign.state.maneuvers)) == (False, 1)


def test_a_decision_by_hand_waits_for_the_verdict() -> None:
    timeline = timeline_of_two()
    campaign = Campaign(Aircraft(), lateral=True, aside=True)
    at_s = 0.0
    while not campaign.is_judging:
        campaign.feed(timeline.up_to(at_s := at_s + 0.5))
    campaign.engineer.exclude(1, "bird strike")
    assert campaign.state.maneuvers[0].excluded_because == "bird strike"


def test_the_information_of_the_input_in_the_air_delays_no_state(monkeypatch: pytest.MonkeyPatch) -> None:
    gate = Event()
    found = Arriving(1e6, {"M_alpha": 90.0})
    monkeypatch.setattr(ArrivingInformation, "follow", lambda *_: found if gate.wait(60.0) else None)
    timeline = timeline_of_two()
    campaign = Campaign(Aircraft(), informs=True, lateral=True, aside=True)
    at_s = 0.0
    while campaign.state.flying is None:
        campaign.feed(timeline.up_to(at_s := at_s + 0.5))
    assert campaign.state.arriving is None
    gate.set()
    deadline_s = monotonic() + 60.0
    while campaign.state.arriving is None:
        assert monotonic() < deadline_s
    assert campaign.state.arriving is found
