"""Keys can be found, explained and changed; what they do is also in the palette."""

import re

import pytest
from textual.command import CommandPalette
from textual.widgets import DataTable, Static

from advisor.session.conducting import LinkHealth
from advisor.session.replay import LogPlayer
from advisor.tui import keys
from advisor.tui.explaining import Explain, keys_at_hand
from advisor.tui.panes.pane import Pane
from advisor.tui.screens.engineer import PANES, EngineerScreen, PaneTabs
from advisor.tui.screens.face import Ask, KeysLine, ReplayBar
from advisor.tui.screens.pilot import PilotScreen
from advisor.tui.settings import Settings
from advisor.words.quantities import clock
from tests.tui import flights
from tests.tui.stage import Stage, stage
from tests.tui.stand_ins import HandFedSource, columns

ENGINEER = Settings(screen="engineer")
BINDINGS = [*keys.EVERYWHERE, *keys.REPLAY, *keys.SELDOM, *keys.ENGINEER, *keys.FIT]


def footer(here: Stage) -> str:
    return str(here.app.screen.query_one(KeysLine).render())


async def test_the_footer_names_the_keys_of_the_screen():
    async with stage(settings=ENGINEER) as here:
        await here.until(lambda: "x Exclude n Note p Pilot e Engineer ? Help q Quit" in footer(here))
        assert "^p More" in footer(here)
        await here.press("p")
        await here.until(lambda: "x Exclude" not in footer(here))


async def test_a_narrow_footer_leaves_keys_away_and_cuts_none_in_two():
    async with stage(settings=ENGINEER, size=(40, 24)) as here:
        await here.until(lambda: "p Pilot" in footer(here))
        assert footer(here).endswith(" e Engineer")


async def test_a_click_on_a_key_of_the_footer_presses_it():
    async with stage() as here:
        await here.until(lambda: "e Engineer" in footer(here))
        await here.pilot.click(KeysLine, offset=(footer(here).index("e Engineer") + 2, 0))
        await here.until(lambda: isinstance(here.app.screen, EngineerScreen))


async def test_one_key_switches_between_the_two_screens():
    async with stage() as here:
        assert isinstance(here.app.screen, PilotScreen)
        await here.press("e")
        assert isinstance(here.app.screen, EngineerScreen)
        await here.press("p")
        assert isinstance(here.app.screen, PilotScreen)


async def test_help_explains_the_pane_that_has_the_focus():
    async with stage(settings=ENGINEER, size=(80, 24)) as here:
        for (key, _), pane in list(zip(keys.PANES, PANES, strict=True))[::5]:
            await here.press(key, "question_mark")
            await here.until(lambda: isinstance(here.app.screen, Explain))
            text = str(here.app.screen.query_one(Static).render())
            assert text.startswith((pane.HELP or "").splitlines()[0].removeprefix("# "))
            assert re.search(r"\nx +Exclude +exclude\n", text)
            await here.press("escape")
            assert isinstance(here.app.screen, EngineerScreen)


@pytest.mark.parametrize("pane", PANES, ids=lambda pane: pane.__name__)
def test_every_pane_has_help_of_its_own(pane: type[Pane]):
    assert len(pane.HELP or "") > 100


async def test_a_number_key_shows_its_pane_and_focuses_it():
    async with stage(settings=ENGINEER, size=(80, 24)) as here:
        for (key, _), pane in zip(keys.PANES, PANES, strict=True):
            await here.press(key)
            around = here.app.focused.ancestors_with_self
            assert any(isinstance(node, pane) and node.display for node in around)


async def test_every_action_can_be_given_another_key():
    async with stage(settings=Settings(screen="engineer", keys={"pilot": "f5", "exclude": "d"})) as here:
        await here.press("p")
        assert isinstance(here.app.screen, EngineerScreen)
        shown = {key.name: key.shown for key in keys_at_hand(here.app)}
        assert (shown["pilot"], shown["exclude"]) == ("f5", "d")
        await here.press("f5")
        assert isinstance(here.app.screen, PilotScreen)


def test_every_binding_has_a_name_of_its_own():
    assert len(keys.ACTIONS) == len(BINDINGS)


def test_no_key_has_two_meanings():
    pressed = [key for binding in BINDINGS for key in binding.key.split(",")]
    assert len(pressed) == len(set(pressed))


async def test_the_help_of_the_fit_lists_the_keys_that_read_values():
    async with stage(settings=ENGINEER, size=(80, 24)) as here:
        await here.press("4", "question_mark")
        await here.until(lambda: isinstance(here.app.screen, Explain))
        text = str(here.app.screen.query_one(Static).render())
        for name in ("cursor_left", "zoom_in", "pan_right", "whole", "lay_over", "copy", "save"):
            assert re.search(rf" {name}\n", text), name


async def test_the_palette_opened_from_the_pilots_screen_offers_the_engineers_actions_too():
    async with stage() as here:
        await here.press("ctrl+p")
        await here.until(lambda: isinstance(here.app.screen, CommandPalette))
        offered = {command.title for command in here.app.get_system_commands(here.app.screen_stack[-2])}
        assert {
            "Pilot", "Engineer", "Help", "Quit", "Theme", "Mark", "Begin manoeuvre", "Finish manoeuvre",
            "Exclude", "Note", "Next output", "Pane: fit",
        } <= offered  # fmt: skip


async def test_an_engineers_action_chosen_on_the_pilots_screen_shows_the_engineers_first():
    async with stage(flights.state(2)) as here:
        (exclude,) = (c for c in here.app.get_system_commands(here.app.screen) if c.title == "Exclude")
        await exclude.callback()
        await here.until(lambda: isinstance(here.app.screen, EngineerScreen))
        await here.until(lambda: here.app.screen.query_one(Ask).display)


@pytest.mark.parametrize("key", ["q", "ctrl+q", "ctrl+c"])
async def test_a_live_link_is_left_only_when_asked_twice(key: str):
    async with stage() as here:
        await here.press(key)
        assert here.app.is_running
        assert here.app._exit is False
        await here.press(key)
        await here.until(lambda: here.app._exit)


async def test_quit_of_the_palette_leaves_a_live_link_no_sooner_than_the_key_does():
    async with stage() as here:
        (leave,) = (c for c in here.app.get_system_commands(here.app.screen) if c.title == "Quit")
        await leave.callback()
        assert here.app._exit is False
        assert "The link is live" in footer(here)


async def test_over_the_help_a_live_link_is_left_only_when_asked_twice():
    async with stage() as here:
        await here.press("question_mark", "ctrl+q")
        assert here.app._exit is False
        await here.press("ctrl+q")
        await here.until(lambda: here.app._exit)


async def test_a_flight_that_is_over_is_left_at_once():
    source = HandFedSource()
    source.condition = LinkHealth("ended", "The flight is over.")
    async with stage(flights.state(2), source=source) as here:
        await here.until(lambda: here.app.view.health.condition == "ended")
        await here.press("q")
        await here.until(lambda: here.app._exit)


async def test_a_replay_is_paused_stepped_and_sped_up_by_keys():
    player = LogPlayer("a.tlog", lambda: [columns(range(5000), [k / 50.0 for k in range(5000)])])
    async with stage(flights.state(2), source=player) as here:
        await here.press("space")
        await here.until(lambda: "paused" in here.words("ReplayBar"))
        assert f"at {clock(here.app.view.state.now_s)}" in here.words("ReplayBar")
        at_s = player.playback().position_s
        await here.press("full_stop")
        await here.until(lambda: player.playback().position_s > at_s)
        assert player.playback().position_s == pytest.approx(at_s + 0.1)
        await here.press("plus", "plus", "minus", "space")
        await here.until(lambda: "replay  2 ×" in here.words("ReplayBar"))


async def test_a_key_for_the_replay_shows_at_once_whatever_the_working_side_does():
    player = LogPlayer("a.tlog", lambda: [columns(range(5000), [k / 50.0 for k in range(5000)])])
    async with stage(flights.state(2), source=player) as here:
        here.app.conductor.play = lambda tempo: None  # type: ignore[method-assign]
        await here.press("space", "plus")
        assert "❚❚ paused  2 ×" in here.words("ReplayBar")


async def test_jumping_asks_for_a_manoeuvre(monkeypatch: pytest.MonkeyPatch):
    player = LogPlayer("a.tlog", lambda: [columns(range(5000), [k / 50.0 for k in range(5000)])])
    async with stage(flights.state(2), source=player) as here:
        asked: list[int] = []
        monkeypatch.setattr(here.app.conductor, "jump", asked.append)
        await here.press("j", "x", "7", "enter", "right_square_bracket", "left_square_bracket")
        assert asked == [7, 3, 2]


async def test_a_live_link_begins_with_the_arrow_keys_in_the_table_every_action_and_no_key_of_a_replay():
    async with stage(settings=ENGINEER) as here:
        assert isinstance(here.app.focused, DataTable), "the manoeuvre table takes the arrow keys"
        offered = {command.title for command in here.app.get_system_commands(here.app.screen)}
        assert {"Pilot", "Exclude", "Note", "Theme", "Mark"} <= offered, "the palette offers every action"
        names = {key.name for key in keys_at_hand(here.app)}
        assert names.isdisjoint({"pause", "jump", "faster"}), "keys of a replay"


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
