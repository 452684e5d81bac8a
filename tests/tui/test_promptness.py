"""What would hold up a key is done before it, or after its answer."""

import gc
from collections.abc import Iterator

import pytest
from textual.css import stylesheet
from textual.events import Key
from textual.widget import Widget

from advisor.session.conducting import SessionReport, View
from advisor.tui import app as application
from advisor.tui.app import Garbage, Sheets
from advisor.tui.plot.painting import Plot
from advisor.tui.settings import Settings
from advisor.tui.themes import NAMES, THEMES
from benchmarks.keys import says
from benchmarks.terminal import terminal
from tests.flights import TWO, recorded
from tests.tui import flights
from tests.tui.stage import Stage, stage


@pytest.fixture
def parsed(monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """What Textual parses from now on."""
    seen: list[object] = []
    parse = stylesheet.parse

    def watched(scope: str, css: str, place: object, **options: object) -> object:
        seen.append(place)
        return parse(scope, css, place, **options)

    monkeypatch.setattr(stylesheet, "parse", watched)
    return seen


@pytest.fixture
def collected() -> Iterator[list[int]]:
    """The generations that Python looks through from now on."""
    seen: list[int] = []

    def watch(phase: str, facts: dict[str, int]) -> None:
        if phase == "start":
            seen.append(facts["generation"])

    gc.callbacks.append(watch)
    yield seen
    gc.callbacks.remove(watch)


def rules(here: Stage) -> list[tuple[str, str]]:
    """How every widget of the screen is styled, and every part of it that has styles of its own."""
    found = []
    for widget in here.app.screen.walk_children(Widget, with_self=True):
        found.append((widget.css_identifier, repr(widget.styles.base.get_rules())))
        styles = {part: widget.get_component_styles(part) for part in sorted(widget.COMPONENT_CLASSES)}
        found += [(part, repr(style.base.get_rules())) for part, style in styles.items()]
    return found


async def both_screens(here: Stage) -> dict[str, list[tuple[str, str]]]:
    """The styles of the engineer's screen, and of the pilot's, which was hidden."""
    found = {}
    for key in "e", "p":
        await here.press(key)
        found[key] = rules(here)
    return found


@pytest.mark.parametrize("theme", NAMES[::2])
async def test_a_theme_that_was_changed_looks_as_one_that_was_there_from_the_start(theme: str):
    async with stage(flights.state(3), settings=Settings(theme=theme)) as here:
        wanted = await both_screens(here)
    before = NAMES[NAMES.index(theme) - 2]
    async with stage(flights.state(3), settings=Settings(theme=before)) as here:
        assert await both_screens(here) != wanted
        await here.press("e", "t", "t")
        assert here.app.theme == theme
        assert await both_screens(here) == wanted


@pytest.mark.study
async def test_no_style_is_parsed_twice_for_a_theme(parsed: list[object]):
    async with stage(flights.state(3)) as here:
        everything = ("e", "question_mark", "escape", "ctrl+p", "escape", "p", "t")
        await here.press(*everything * len(NAMES))
        assert parsed
        parsed.clear()
        await here.press(*everything * len(NAMES))
        assert not parsed


async def test_styles_of_the_other_themes_are_parsed_while_no_key_is_pressed(monkeypatch, parsed):
    monkeypatch.setattr(application, "_QUIET_S", 0.01)
    async with stage(flights.state(3)) as here:
        await here.until(
            lambda: all(parsed.count(place) >= len(NAMES) for place in here.app.stylesheet.source)
        )
        parsed.clear()
        await here.press(*"t" * len(NAMES))
        assert not parsed


def test_the_name_of_a_theme_is_painted_with_its_colours(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("COLORTERM", "truecolor")
    log = recorded("linear", 1.0, maneuvers=TWO[:1])
    with terminal(str(log), screen="engineer") as here:
        here.until(says("Manoeuvres"))
        for theme in THEMES[1:]:
            here.press(b"t")
            said = b""
            while f"theme: {theme.name}".encode() not in said:
                said += here.read()
            red, green, blue = bytes.fromhex(theme.background.removeprefix("#"))
            assert f"48;2;{red};{green};{blue}m".encode() in said


async def test_an_answer_is_painted_before_anything_is_tidied_up(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(application, "_QUIET_S", 1e6)
    done: list[str] = []
    paint, prepare = Plot.render_line, Sheets.prepare
    monkeypatch.setattr(Plot, "render_line", lambda plot, y: (done.append("painted"), paint(plot, y))[1])
    monkeypatch.setattr(
        Sheets, "prepare", lambda sheets, now: (done.append("tidied"), prepare(sheets, now))[1]
    )
    async with stage(flights.state(3), settings=Settings(screen="engineer")) as here:
        for _ in NAMES:
            done.clear()
            await here.press("t")
            await here.until(lambda: "tidied" in done)
            assert done[0] == "painted"


async def test_garbage_is_collected_after_an_answer(monkeypatch: pytest.MonkeyPatch, collected: list[int]):
    monkeypatch.setattr(application, "_QUIET_S", 1e6)
    async with stage(flights.state(3)) as here:
        collected.clear()
        waste = [[k] for k in range(10_000)]
        await here.pilot.pause(0.2)
        assert not collected
        # The styles of the other themes come before.
        for key in "epep":
            await here.press(key)
            await here.pilot.pause(0.1)
        assert collected
        del waste


async def test_garbage_is_collected_when_no_key_comes(monkeypatch: pytest.MonkeyPatch, collected: list[int]):
    monkeypatch.setattr(application, "_QUIET_S", 0.01)
    async with stage(flights.state(3)) as here:
        waste = [[k] for k in range(10_000)]
        collected.clear()
        await here.until(lambda: 0 in collected)
        del waste


def test_what_outlived_some_collections_is_looked_at_too(collected: list[int]):
    garbage = Garbage()
    garbage.begin()
    try:
        kept = []
        while 2 not in collected:
            kept.append([[k] for k in range(10_000)])
            assert len(kept) < 10
            garbage.collect_if_due()
        assert set(collected) == {0, 2}
    finally:
        garbage.end()


async def test_the_application_leaves_the_collector_as_it_was():
    before = gc.isenabled(), gc.get_threshold(), gc.get_freeze_count()
    async with stage() as here:
        assert not gc.isenabled()
        assert here.app.is_running
    assert (gc.isenabled(), gc.get_threshold(), gc.get_freeze_count()) == before


async def test_reports_behind_a_key_wait_for_its_answer_and_then_the_newest_is_shown(monkeypatch):
    async with stage(flights.state(3)) as here:
        app, states = here.app, []
        # The campaign has nothing more to say: a report of its own would be a newer one.
        app.conductor.stop()
        await here.until(lambda: all(worker.is_finished for worker in app.workers))
        show = app.show

        def watched(view: View) -> None:
            states.append(view.state)
            show(view)

        monkeypatch.setattr(app, "show", watched)
        reports = [
            SessionReport(flights.state(n), app.view.health, app.view.playback, app.view.log) for n in (4, 5)
        ]
        await app.on_event(Key("1", "1"))
        for report in reports:
            app.on_advisor_app_told(app.Told(report))
        assert states == []
        await here.until(lambda: reports[1].state in states)
        assert reports[0].state not in states
