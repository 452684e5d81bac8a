"""A manoeuvre is marked by two keys, on either screen, and kept beside the log."""

import shutil
from dataclasses import replace
from functools import partial
from math import inf
from pathlib import Path

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis.marks_file import keep_by_hand, path_beside, read_by_hand
from advisor.campaign.campaign import Campaign
from advisor.campaign.state import ByHand
from advisor.mavlink.logs.logs import open_log
from advisor.session.conducting import Tempo
from advisor.session.conductor import Conductor
from advisor.session.live import LinkSource
from advisor.session.replay import LogPlayer
from advisor.tui.app import AdvisorApp
from advisor.tui.screens.face import KeysLine
from advisor.tui.settings import Settings
from tests.flights import TWO, recorded
from tests.tui import flights
from tests.tui.stage import Stage, stage
from tests.tui.stand_ins import HandFedSource


def last_line(here: Stage) -> str:
    return str(here.app.screen.query_one(KeysLine).render())


@pytest.mark.parametrize("screen", ["pilot", "engineer"])
async def test_one_key_begins_a_mark_and_another_ends_it(screen: str):
    source = HandFedSource()
    async with stage(flights.state(3), settings=Settings(screen=screen), source=source) as here:
        await here.press("b")
        assert "a manoeuvre is marked from here" in last_line(here)
        await here.until(lambda: here.app.view.state.marking_since_s is not None)
        await here.press("f")
        await here.until(lambda: len(here.campaign.engineer.decided.marks) == 1)
        assert "its verdict follows" in last_line(here)
        await here.until(lambda: source.kept != [])
        assert source.kept[-1].marks == here.campaign.engineer.decided.marks


async def test_ending_what_was_not_begun_says_so_and_marks_nothing():
    async with stage(flights.state(3)) as here:
        await here.press("f")
        assert "begin one first" in last_line(here)
        assert here.campaign.engineer.decided.marks == ()


async def test_the_pilots_screen_shows_for_how_long_a_mark_has_been_open():
    state = flights.state(3)
    source = HandFedSource()
    later = replace(state, now_s=state.now_s + 7.0)
    async with stage(state, later, source=source) as here:
        await here.press("b")
        source.deliver()
        await here.until(lambda: "marked by hand for 7 s" in here.words("CrewNotes"))


def opened(log: Path, speed: float, settings: Settings) -> tuple[AdvisorApp, LogPlayer]:
    """The application over a log, with the campaign in this process."""
    columns = [piece for batch in open_log(log) for piece in batch]
    player = LogPlayer(log.name, lambda: columns, speed, keep_beside=[log])

    def make(by_hand: ByHand) -> Campaign:
        return Campaign(Aircraft(), informs=True, by_hand=by_hand)

    conductor = Conductor(player, make, read_by_hand(log))
    return AdvisorApp(conductor, Aircraft(), log.name, Tempo(speed=speed), settings), player


async def test_a_mark_made_in_a_replay_is_judged_kept_and_there_again_in_the_next(tmp_path: Path):
    log = Path(shutil.copy(recorded("linear", 1.0, maneuvers=TWO[:1]), tmp_path / "flight.tlog"))
    app, player = opened(log, 8.0, Settings())
    async with app.run_test(size=(80, 24)) as pilot:
        here = Stage(app, pilot, None, player)
        await here.until(lambda: app.view.state.now_s > 26.0, patience_s=60.0)
        await here.press("b")
        await here.until(lambda: app.view.state.marking_since_s is not None)
        since_s = app.view.state.marking_since_s
        await here.until(lambda: app.view.state.now_s > 37.0, patience_s=60.0)
        await here.press("f")
        await here.until(lambda: len(app.view.state.maneuvers) == 1, patience_s=60.0)
        marked = app.view.state.maneuvers[0]
        assert marked.maneuver.span.closed_by == "marked by hand"
        await here.press("space", "e", "n", *"bumpy", "enter")
        await here.until(lambda: "bumpy" in path_beside(log).read_text(encoding="utf-8"))
        await here.until(lambda: "decisions by hand are kept in" in "\n".join(app.view.log))
    app, player = opened(log, inf, Settings())
    async with app.run_test(size=(80, 24)) as pilot:
        here = Stage(app, pilot, None, player)
        await here.until(lambda: app.view.health.condition == "ended", patience_s=60.0)
        again = app.view.state.maneuvers[0]
        assert again.maneuver.span == marked.maneuver.span
        assert again.verdict == marked.verdict
        assert again.notes == ("bumpy",)
        (kept,) = read_by_hand(log).marks
        assert kept.start_s == since_s


async def test_a_mark_begun_and_ended_at_the_same_moment_is_refused_in_the_log(tmp_path: Path):
    log = Path(shutil.copy(recorded("uav", 1.0, maneuvers=()), tmp_path / "flight.tlog"))
    app, player = opened(log, inf, Settings())
    async with app.run_test(size=(80, 24)) as pilot:
        here = Stage(app, pilot, None, player)
        await here.until(lambda: app.view.health.condition == "ended", patience_s=60.0)
        await here.press("b")
        await here.until(lambda: app.view.state.marking_since_s is not None)
        await here.press("f")
        await here.until(lambda: "a mark lasts more than 0" in "\n".join(app.view.log))
        assert not path_beside(log).exists()


def test_nothing_is_marked_before_the_vehicles_clock_is_heard():
    campaign = Campaign(Aircraft())
    campaign.engineer.begin_maneuver()
    campaign.engineer.mark("engine start")
    campaign.engineer.end_maneuver()
    assert campaign.engineer.decided == ByHand()
    assert campaign.state.marking_since_s is None
    assert campaign.state.notices[0].strip() == "–  nothing can be marked before the vehicle's clock is heard"


def test_without_a_recording_a_link_says_that_decisions_are_not_kept():
    said = LinkSource(None).keep(ByHand())  # type: ignore[arg-type]
    assert "not kept, because nothing is recorded" in said


def test_a_replay_without_marks_keeps_none():
    said = LogPlayer("a.tlog", list).keep(ByHand())
    assert "they hold until you quit" in said


def test_a_folder_that_cannot_be_written_is_told_and_ends_nothing(tmp_path: Path):
    keep = partial(keep_by_hand, tmp_path / "gone" / "flight.tlog")
    assert "cannot be kept" in keep(ByHand())
