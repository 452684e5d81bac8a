"""Every size, every theme, no colour: something readable stands everywhere."""

import re
from dataclasses import replace

import pytest
from textual.color import Color
from textual.theme import Theme
from textual.widgets import DataTable, Static

from advisor.tui import keys
from advisor.tui.panes.pane import Lines, Pane
from advisor.tui.panes.pilot import BigWord
from advisor.tui.plot.painting import Plot
from advisor.tui.settings import Settings
from advisor.tui.themes import NAMES, THEMES
from tests.tui import flights
from tests.tui.stage import Stage, shown, stage

SIZES = [(80, 24), (320, 90)]
NOTHING = replace(flights.state(0), vehicle=None, channels={}, notices=())


def text(widget: Plot) -> str:
    """What a plot has painted."""
    return "\n".join(widget.render_line(y).text for y in range(widget.size.height))


def panes(here: Stage) -> list[Pane]:
    return [pane for pane in here.app.screen.query(Pane) if pane.display]


def around(plot: Plot, kind: type[Pane]) -> Pane:
    """The pane that a plot stands in."""
    return next(node for node in plot.ancestors if isinstance(node, kind))


def inside(here: Stage, pane: Pane) -> bool:
    """Whether a pane lies on the screen with room for something."""
    return here.app.screen.region.contains_region(pane.region) and pane.region.area > 60


@pytest.mark.parametrize(
    ("state", "size"),
    [(NOTHING, SIZES[0]), *((flights.state(5, in_the_air=True), size) for size in SIZES)],
    ids=["nothing", "flown, small", "flown, large"],
)
async def test_no_pane_is_blank_and_every_axis_carries_its_unit_at_any_size(state, size: tuple[int, int]):
    async with stage(state, size=size, settings=Settings(screen="engineer")) as here:
        for key, _ in keys.PANES[1:]:
            await here.press(key)
            # A busy machine lays a pane out after it is shown.
            await here.until(lambda: all(inside(here, pane) for pane in panes(here)))
            for pane in panes(here):
                said = [str(w.render()) for w in pane.query(Lines) if shown(w)]
                said += [text(plot) for plot in pane.query(Plot) if shown(plot)]
                said += [str(pane.border_subtitle)]
                said += ["row" for table in pane.query(DataTable) if table.row_count]
                said += [str(matrix.render()) for matrix in pane.query("#matrix").results(Static)]
                assert any(len(words.strip()) > 2 for words in said), pane
                assert all(text(plot).strip() for plot in pane.query(Plot) if shown(plot)), pane
            for plot in here.app.screen.query(Plot):
                if shown(plot) and plot.chart.series and plot.size.height >= 4:
                    lines = text(plot).split("\n")
                    assert plot.chart.y_label in lines[0], plot
                    assert not plot.chart.foot or lines[-1].rstrip().endswith(plot.chart.x_label), plot
                    assert around(plot, Pane).region.contains_region(plot.region), plot


@pytest.mark.parametrize(("size", "count"), [((80, 24), 2), ((120, 40), 4), ((200, 60), 8)])
async def test_wider_terminals_show_more_panes_at_once(size: tuple[int, int], count: int):
    async with stage(size=size, settings=Settings(screen="engineer")) as here:
        assert len(panes(here)) == count


async def test_a_pane_of_the_left_column_leaves_the_one_beside_it_in_place():
    async with stage(flights.state(3), size=(120, 40), settings=Settings(screen="engineer")) as here:
        for key in "6", "2", "3", "1":
            await here.press(key)
            assert [type(pane).__name__ for pane in panes(here)] == [
                "Maneuvers",
                "VerdictPane",
                "ParametersPane",
                "Criterion",
            ]


async def test_all_tabs_have_room_on_eighty_columns():
    async with stage(size=(80, 24), settings=Settings(screen="engineer")) as here:
        await here.press("3")
        tabs = here.page().split("\n")[1]
        assert tabs.startswith("1Man 2Ver [3Par] 4Fit")
        assert tabs.endswith("9Res 0Cor hHis uFQ iFlt dGap")


@pytest.mark.parametrize("size", SIZES, ids=str)
async def test_the_pilot_reads_the_word_in_block_letters_at_any_size(size: tuple[int, int]):
    async with stage(flights.state(7), size=size) as here:
        await here.until(lambda: here.app.screen.query_one(BigWord).word == "TEST COMPLETE")
        word = here.app.screen.query_one(BigWord)
        assert "█" in str(word.render())
        for part in here.app.screen.query(Lines):
            assert not shown(part) or here.app.screen.region.contains_region(part.region)


@pytest.mark.parametrize("theme", THEMES, ids=lambda theme: theme.name)
async def test_every_theme_paints_both_screens(theme: Theme):
    async with stage(flights.state(3), settings=Settings(theme=theme.name)) as here:
        await here.press("e")
        assert here.app.theme == theme.name
        plot = here.app.screen.query_one("#fit-alpha", Plot)
        await here.until(lambda: bool(plot.chart.series))
        assert {theme.variables["ink-measured"], theme.variables["ink-fitted"]} <= colours(plot)


async def test_a_theme_changed_on_one_screen_is_there_on_the_other():
    async with stage(flights.state(3)) as here:
        await here.press("e")
        plot = here.app.screen.query_one("#fit-alpha", Plot)
        await here.until(lambda: THEMES[0].variables["ink-fitted"] in colours(plot))
        await here.press("p", "t", "e")
        await here.until(lambda: THEMES[1].variables["ink-fitted"] in colours(plot))
        assert here.app.screen.styles.background == Color.parse(THEMES[1].background)


async def test_only_themes_that_can_paint_everything_are_offered():
    async with stage() as here:
        assert set(here.app.available_themes) == set(NAMES)


def colours(plot: Plot) -> set[str]:
    """Every colour of ink on a plot."""
    painted = [segment.style for y in range(plot.size.height) for segment in plot.render_line(y)]
    return {style.color.get_truecolor().hex for style in painted if style and style.color}


@pytest.mark.parametrize("theme", THEMES, ids=lambda theme: theme.name)
def test_text_stands_out_from_its_background_in_every_theme(theme):
    background = Color.parse(theme.background)
    for name in ("foreground", "success", "warning", "error", "primary"):
        assert contrast(Color.parse(getattr(theme, name)), background) >= 4.5, name


@pytest.mark.parametrize("theme", THEMES, ids=lambda theme: theme.name)
def test_a_scroll_bar_stands_out_from_its_background_in_every_theme(theme):
    background = Color.parse(theme.background)
    track = background + Color.parse(theme.variables["scrollbar-background"])
    for state in ("scrollbar", "scrollbar-hover", "scrollbar-active"):
        bar = Color.parse(theme.variables[state])
        assert contrast(bar, background) >= 3.0
        assert contrast(bar, track) >= 2.5


def contrast(a: Color, b: Color) -> float:
    """Contrast ratio of WCAG 2.1, 1 to 21; 4.5 is its level AA for text, 3 for what is no text."""
    high, low = sorted((luminance(a), luminance(b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def luminance(colour: Color) -> float:
    parts = [c / 255.0 for c in (colour.r, colour.g, colour.b)]
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in parts]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


async def test_the_theme_key_goes_round():
    async with stage() as here:
        seen = [here.app.theme]
        for _ in NAMES:
            await here.press("t")
            seen.append(here.app.theme)
        assert seen == [*NAMES, NAMES[0]]


async def test_without_colour_everything_is_grey(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("NO_COLOR", "1")
    async with stage(flights.state(3)) as here:
        await here.until(lambda: "✗" in here.words())
        svg = here.app.export_screenshot()
        colours = set(re.findall(r"fill: #([0-9a-f]{6})", svg))
        assert colours
        assert all(abs(int(c[:2], 16) - int(c[4:], 16)) <= 4 for c in colours), colours
