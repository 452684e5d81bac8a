"""Pages at the server's door: all show one campaign, and say what they may of it."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from multiprocessing import Pipe
from threading import Thread

import pytest

from advisor.campaign.state import HandDecision
from advisor.session.conducting import LinkRequest, SessionReport
from advisor.session.conductor import Conductor
from advisor.tui.explaining import keys_at_hand
from advisor.tui.settings import Settings
from advisor.web import viewer
from advisor.web.showing import Audience, Showing, Viewing
from advisor.web.viewer import AttachedConductor, ServerGoneError, ViewerApp, WatchingApp
from tests.mavlink.link.builders import wait_until
from tests.tui import flights
from tests.tui.stage import Stage
from tests.tui.stand_ins import HandFedSource, StagedCampaign, staged

BY_HAND = {"exclude", "note", "mark", "begin_maneuver", "end_maneuver", "follow", "outputs", "guess"}


class Server:
    """One campaign on a link, and the door to it."""

    def __init__(self, watch_only: bool) -> None:
        self.campaign: StagedCampaign = staged()
        self.source = HandFedSource()
        settings = Settings(screen="engineer")
        self.viewing = Viewing(flights.AIRCRAFT, "udpin:127.0.0.1:0", None, settings, watch_only)
        self.showing = Showing(Conductor(self.source, lambda by_hand: self.campaign))
        self.audience = Audience(self.viewing, self.showing, self._nobodys_own)

    def page(self) -> AttachedConductor:
        """A page that has just come, and has been told what to show."""
        connection = self.audience.door.open()
        assert connection.recv() == self.viewing
        return AttachedConductor(connection)

    def _nobodys_own(self) -> Conductor:
        raise AssertionError("a page of a live link has no campaign of its own")


@contextmanager
def at_work(watch_only: bool = False) -> Iterator[Server]:
    """A server until the end of the context."""
    server = Server(watch_only)
    with server.showing, server.audience:
        yield server


@contextmanager
def watching(conductor: AttachedConductor) -> Iterator[Callable[[], SessionReport | None]]:
    """The newest report that a page has."""
    reports: list[SessionReport] = []
    thread = Thread(target=conductor.run, args=(reports.append,))
    thread.start()
    yield lambda: reports[-1] if reports else None
    conductor.stop()
    thread.join()


def test_what_one_page_decides_is_seen_on_all_and_by_a_page_that_comes_later() -> None:
    with at_work() as server, watching(one := server.page()), watching(server.page()) as other:
        wait_until(lambda: other() is not None)
        one.decide(HandDecision("exclude", "gust", 3))
        one.order(LinkRequest("outputs"))
        wait_until(lambda: excluded(other()) == {3: "gust"})
        with watching(server.page()) as late:
            wait_until(lambda: excluded(late()) == {3: "gust"})
        assert server.source.orders == [LinkRequest("outputs")]
        assert len(server.source.kept) == 1


def test_a_page_that_only_watches_is_not_heeded() -> None:
    with at_work(watch_only=True) as server, watching(page := server.page()) as seen:
        page.decide(HandDecision("mark", "gust"))
        page.order(LinkRequest("follow", 2))
        wait_until(lambda: seen() is not None)
        time.sleep(0.2)
        assert server.campaign.calls == []
        assert server.source.orders == []


@pytest.mark.parametrize(("watch_only", "kind"), [(False, ViewerApp), (True, WatchingApp)])
async def test_a_page_offers_the_keys_that_it_may_use_and_is_left_at_once(watch_only, kind):
    with at_work(watch_only) as server:
        app = kind(server.viewing, server.page())
        async with app.run_test(size=(120, 40)) as pilot:
            here = Stage(app, pilot, server.campaign, server.source)
            await here.until(lambda: len(app.view.state.maneuvers) == 7)
            offered = BY_HAND.intersection(key.name for key in keys_at_hand(app))
            assert offered == (set() if watch_only else BY_HAND)
            await here.press("q")
            await here.until(lambda: not app.is_running)
        assert server.showing.at_work


def test_a_page_says_that_its_server_does_not_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(viewer, "OLD_AFTER_S", 0.3)
    ours, theirs = Pipe()
    with ours, theirs, watching(AttachedConductor(ours)) as seen:
        theirs.send(SessionReport(flights.state(3), HandFedSource().condition, None, ()))
        wait_until(lambda: (report := seen()) is not None and report.health.condition == "stale")
        report = seen()
        assert report is not None
        assert report.health.alarm.startswith("SERVER NOT ANSWERING for 0 s")


def test_a_page_ends_with_its_server() -> None:
    with at_work() as server:
        page = server.page()
    with pytest.raises(ServerGoneError):
        page.run(lambda report: None)


def excluded(report: SessionReport | None) -> dict[int, str]:
    """Manoeuvres that a report shows as taken out by hand, with the reason."""
    judged = report.state.maneuvers if report else ()
    return {j.maneuver.number: j.excluded_because for j in judged if j.excluded_because is not None}
