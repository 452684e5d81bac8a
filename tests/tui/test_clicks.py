"""The mouse goes where a key goes."""

import pytest

from advisor.session.replay import LogPlayer
from advisor.tui.panes.replay_bar import ReplayBar
from advisor.tui.screens.engineer import PaneTabs
from advisor.tui.settings import Settings
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import columns


def hundred_seconds() -> LogPlayer:
    return LogPlayer("a.tlog", lambda: [columns(range(5000), [k / 50.0 for k in range(5000)])])


async def test_a_click_on_the_name_of_a_pane_shows_it() -> None:
    async with stage(flights.state(3), size=(80, 24), settings=Settings(screen="engineer")) as here:
        column = str(here.app.screen.query_one(PaneTabs).render()).index("6Cri") + 2
        await here.pilot.click(PaneTabs, offset=(column, 0))
        await here.pilot.pause()
        assert here.app.screen.query_one("Criterion").display


async def test_a_click_on_the_replay_bar_goes_there(monkeypatch: pytest.MonkeyPatch) -> None:
    async with stage(flights.state(3), source=hundred_seconds()) as here:
        await here.until(lambda: "━" in here.words("ReplayBar") or "─" in here.words("ReplayBar"))
        asked: list[float] = []
        monkeypatch.setattr(here.app.conductor, "seek", asked.append)
        text = here.words("ReplayBar")
        middle = min(k for k, sign in enumerate(text) if sign in "━─") + 12
        await here.pilot.click(ReplayBar, offset=(middle + 1, 0))
        await here.pilot.pause()
        assert asked == [pytest.approx(50.0, abs=0.1)]


async def test_keys_go_ten_seconds_on_and_back(monkeypatch: pytest.MonkeyPatch) -> None:
    async with stage(flights.state(3), source=hundred_seconds()) as here:
        await here.until(lambda: here.app.view.playback is not None and here.app.view.playback.duration_s > 0)
        asked: list[float] = []
        monkeypatch.setattr(here.app.conductor, "seek", asked.append)
        await here.press("space")
        position_s = here.app.view.playback.position_s
        await here.press("right_curly_bracket", "left_curly_bracket")
        assert asked == [pytest.approx(position_s + 10.0, abs=1.0), 0.0]
