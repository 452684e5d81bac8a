"""The working thread: order, requests, jumps, and what happens when something breaks."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from math import inf

import numpy as np
import pytest

from advisor.campaign.state import ByHand, CampaignState, HandDecision, JudgedManeuver
from advisor.flight.signals.messages import Columns
from advisor.session.conducting import SessionReport
from advisor.session.conductor import Conductor
from advisor.session.replay import LogPlayer
from advisor.words.problems import UnusableInputError
from tests.campaign.states import changed
from tests.tui import flights
from tests.tui.stand_ins import HandFedSource, StagedCampaign, columns, staged

A_MANEUVER = 500
"""Messages from one verdict to the next; the manoeuvre is in the air for the last 100 of them."""

one = cache(flights.judged)


def log(maneuvers: int = 4) -> list[Columns]:
    order = np.arange(maneuvers * A_MANEUVER)
    return [columns(order, order / 50.0)]


class CountingCampaign(StagedCampaign):
    """Judges a manoeuvre at every five-hundredth message."""

    def __init__(self, by_hand: ByHand) -> None:
        super().__init__([flights.state(0)], by_hand=by_hand)

    @property
    def state(self) -> CampaignState:
        count = len(self.fed)
        done = tuple(self._judged(k) for k in range(1, count // A_MANEUVER + 1))
        in_the_air = one(len(done) + 1).maneuver if count % A_MANEUVER >= 400 else None
        return changed(super().state, maneuvers=done, flying=in_the_air, now_s=count / 50.0)

    def _judged(self, number: int) -> JudgedManeuver:
        whole = one(number)
        start_s = (number * A_MANEUVER - 100) / 50.0
        maneuver = whole.maneuver.later(start_s - whole.maneuver.span.start_s)
        excluded, notes = self.decided.excluded_because(maneuver), self.decided.notes_on(maneuver)
        return replace(whole, maneuver=maneuver, excluded_because=excluded, notes=notes)


class Flown:
    """A conductor over a replay, with every campaign it made and every report it gave."""

    def __init__(self, speed: float = inf) -> None:
        self.player = LogPlayer("x", log, speed, lambda changed, seconds: None)
        self.campaigns: list[CountingCampaign] = []
        self.reports: list[SessionReport] = []
        self.script: list[tuple[Callable[[SessionReport], bool], Callable[[], None]]] = []
        self.conductor = Conductor(self.player, self._make)

    def _make(self, by_hand: ByHand) -> CountingCampaign:
        self.campaigns.append(CountingCampaign(by_hand))
        return self.campaigns[-1]

    def _tell(self, report: SessionReport) -> None:
        self.reports.append(report)
        if self.script and self.script[0][0](report):
            self.script.pop(0)[1]()

    def when(self, condition: Callable[[SessionReport], bool], then: Callable[[], None]) -> None:
        """The next step of what the user does."""
        self.script.append((condition, then))

    def run(self, campaigns: int = 1) -> None:
        """To the end of the log in the last of so many campaigns."""
        self.when(lambda report: over(report) and len(self.campaigns) == campaigns, self.conductor.stop)
        self.conductor.run(self._tell)


def over(report: SessionReport) -> bool:
    return report.health.condition == "ended"


def always(report: SessionReport) -> bool:
    return True


@pytest.fixture(autouse=True)
def every_batch_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("advisor.session.conductor.REPORT_EVERY_S", 0.0)


def test_a_log_is_fed_whole_in_order_and_finished():
    flight = Flown()
    flight.run()
    assert flight.campaigns[0].fed == list(range(4 * A_MANEUVER))
    assert flight.campaigns[0].calls == [("finish",)]


def test_jumping_back_starts_a_new_campaign_and_ends_just_before_the_manoeuvre():
    flight = Flown(speed=2.0)
    flight.when(over, lambda: flight.conductor.jump(3))
    flight.run(campaigns=2)
    before = next(k for k, report in enumerate(flight.reports) if over(report))
    landed = next(r for r in flight.reports[before:] if not over(r) and not r.playback.hurrying)
    assert len(flight.campaigns) == 2
    assert len(landed.state.maneuvers) == 2
    assert 27.0 <= landed.state.now_s <= 27.6
    assert flight.campaigns[1].fed == list(range(4 * A_MANEUVER))


@pytest.mark.parametrize(("speed", "waits"), [(1.0, False), (2.0, True), (inf, True)])
def test_a_log_that_is_played_faster_than_flown_waits_for_every_verdict(speed: float, waits: bool):
    flight = Flown(speed)
    flight.run()
    assert (flight.campaigns[0].waited > 0) is waits


@pytest.mark.parametrize("judging_s", [1.0, 60.0])
def test_the_conductor_falls_silent_behind_an_estimate_that_hangs(judging_s, monkeypatch):
    monkeypatch.setattr(StagedCampaign, "judging_s", judging_s)
    flight = Flown(speed=1.0)
    flight.run()
    assert (flight.campaigns[0].waited > 0) is (judging_s > 20.0)


def test_jumping_ahead_keeps_the_campaign_and_the_pace():
    flight = Flown(speed=1.0)
    flight.when(always, lambda: flight.conductor.jump(2))
    flight.run()
    arrived = next(r for r in flight.reports if r.state.flying is not None and r.state.flying.number == 2)
    assert len(flight.campaigns) == 1
    assert not arrived.playback.hurrying
    assert len(arrived.state.maneuvers) == 1
    assert flight.campaigns[0].fed == list(range(4 * A_MANEUVER))


def test_a_jump_beyond_the_end_stops_there():
    flight = Flown(speed=2.0)
    flight.when(always, lambda: flight.conductor.jump(99))
    flight.run()
    assert not flight.player.playback().hurrying


def test_decisions_by_hand_survive_a_jump_back():
    flight = Flown()
    flight.when(over, lambda: flight.conductor.decide(HandDecision("exclude", "gust", 2)))
    flight.when(always, lambda: flight.conductor.decide(HandDecision("note", "look again", 3)))
    flight.when(always, lambda: flight.conductor.jump(1))
    flight.run(campaigns=2)
    _, second, third = flight.reports[-1].state.maneuvers[:3]
    assert second.excluded_because == "gust"
    assert third.notes == ("look again",)


def test_including_again_records_its_reason_as_a_note():
    campaign = staged()
    campaign.engineer.apply(HandDecision("include", "the gust was harmless", 2))
    assert campaign.calls == [("include", 2), ("note", 2, "included again: the gust was harmless")]


def test_a_moment_and_a_manoeuvre_that_were_marked_are_known_from_the_start_after_a_jump_back():
    flight = Flown()
    decide = flight.conductor.decide
    flight.when(lambda r: r.state.now_s >= 3.0, lambda: decide(HandDecision("mark", "flaps")))
    flight.when(always, lambda: decide(HandDecision("begin")))
    flight.when(lambda r: r.state.now_s >= 5.0, lambda: decide(HandDecision("end")))
    flight.when(over, lambda: flight.conductor.jump(1))
    flight.run(campaigns=2)
    first, second = flight.campaigns
    assert second.engineer.decided == first.engineer.decided
    assert [remark.text for remark in second.engineer.decided.remarks] == ["flaps"]
    assert 5.0 <= second.engineer.decided.marks[0].end_s <= 6.5


def test_every_decision_by_hand_is_kept_with_its_source_and_said():
    source = HandFedSource()
    source.deliver()
    reports: list[SessionReport] = []
    conductor = Conductor(source, staged)

    def tell(report: SessionReport) -> None:
        reports.append(report)
        if source.kept:
            conductor.stop()

    conductor.decide(HandDecision("exclude", "gust", 2))
    conductor.run(tell)
    assert [remark.text for remark in source.kept[-1].excluded] == ["gust"]
    assert reports[-1].log[-1].endswith("decisions by hand are kept")


def test_a_decision_on_a_manoeuvre_still_to_come_waits_for_it():
    flight = Flown()
    flight.when(always, lambda: flight.conductor.decide(HandDecision("exclude", "known gust", 3)))
    flight.run()
    assert flight.reports[0].state.maneuvers == ()
    assert flight.reports[-1].state.maneuvers[2].excluded_because == "known gust"


def test_unusable_input_ends_the_thread_and_closes_the_source():
    source = HandFedSource()
    source.batches.put(UnusableInputError("rate", "AOA_SSA arrives at 4 Hz.", "Ask for 50 Hz."))
    with pytest.raises(UnusableInputError):
        Conductor(source, staged).run(lambda report: None)
    assert source.closed


def test_the_campaign_is_made_in_the_working_thread_only():
    made: list[StagedCampaign] = []

    def make(by_hand: ByHand) -> StagedCampaign:
        made.append(staged(by_hand))
        return made[-1]

    conductor = Conductor(HandFedSource(), make)
    assert not made
    conductor.stop()
    conductor.run(lambda report: None)
    assert len(made) <= 1


def test_cutting_the_stream_differently_feeds_the_same():
    fed: list[Sequence[int]] = []
    for speed in (1.0, 8.0, inf):
        flight = Flown(speed)
        flight.run()
        fed.append(flight.campaigns[0].fed)
    assert fed[0] == fed[1] == fed[2]


def test_a_replay_hurries_through_the_time_before_its_data_and_no_further() -> None:
    waits: list[float] = []
    player = LogPlayer("x", log, 1.0, lambda changed, seconds: waits.append(seconds))
    waited_at_begin: list[int] = []

    class LateCampaign(CountingCampaign):
        @property
        def state(self) -> CampaignState:
            begun = len(self.fed) >= A_MANEUVER
            if begun and not waited_at_begin:
                waited_at_begin.append(len(waits))
            return replace(super().state, serves=begun)

    conductor = Conductor(player, LateCampaign)
    conductor.run(lambda report: conductor.stop() if len(waits) > 3 else None)
    assert waited_at_begin == [0]


def test_going_back_some_seconds_starts_a_new_campaign_and_stops_there():
    flight = Flown(speed=2.0)
    flight.when(over, lambda: flight.conductor.seek(12.0))
    flight.run(campaigns=2)
    before = next(k for k, report in enumerate(flight.reports) if over(report))
    landed = next(r for r in flight.reports[before:] if not over(r) and not r.playback.hurrying)
    assert 12.0 <= landed.playback.position_s <= 12.6


def test_going_on_some_seconds_keeps_the_campaign():
    flight = Flown(speed=1.0)
    flight.when(always, lambda: flight.conductor.seek(20.0))
    flight.run()
    landed = next(r for r in flight.reports if not r.playback.hurrying and r.playback.position_s >= 20.0)
    assert landed.playback.position_s <= 20.6
    assert len(flight.campaigns) == 1
