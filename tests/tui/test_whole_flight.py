"""The pane of the whole flight."""

from dataclasses import replace

import pytest

from advisor.session.replay import LogPlayer
from advisor.tui.plot.widget import Plot
from advisor.tui.settings import Settings
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.stand_ins import columns

ENGINEER = Settings(screen="engineer")


async def test_every_channel_stands_over_the_whole_flight_with_manoeuvres_and_modes() -> None:
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45)) as here:
        await here.press("i")
        await here.until(lambda: "1✓" in here.words("#whole-maneuvers"))
        assert here.words("#whole-maneuvers").split() == ["1✓", "2✗", "3✓", "4✓"]
        modes = here.words("#whole-modes")
        assert modes.split() == ["modes", "│FBWA", "│MANUAL"]
        room = here.app.screen.query_one("#whole-modes").size.width - len("modes  ")
        assert modes.index("│MANUAL") - modes.index("│FBWA") == pytest.approx(room * 40.0 / 159.5, abs=2)
        for name in ("elevator", "alpha", "q", "airspeed"):
            chart = here.app.screen.query_one(f"#whole-{name}", Plot).chart
            assert chart.series
            assert chart.x_range == (40.0, pytest.approx(199.5))


async def test_a_rejected_manoeuvre_and_a_power_on_before_are_told_apart() -> None:
    state = replace(flights.state(4), boot=1)
    async with stage(state, settings=ENGINEER, size=(140, 45)) as here:
        await here.press("i")
        await here.until(lambda: "modes" in here.words("#whole-modes"))
        assert here.words("#whole-maneuvers") == ""


async def test_a_click_jumps_to_the_manoeuvre_there(monkeypatch: pytest.MonkeyPatch) -> None:
    player = LogPlayer("a.tlog", lambda: [columns(range(5000), [k / 50.0 for k in range(5000)])])
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45), source=player) as here:
        await here.press("i")
        await here.until(lambda: "modes" in here.words("#whole-modes"))
        asked: list[int] = []
        monkeypatch.setattr(here.app.conductor, "jump", asked.append)
        plot = here.app.screen.query_one("#whole-q", Plot)
        plot.post_message(Plot.Pointed(132.0))
        await here.until(lambda: asked == [2])


async def test_the_key_l_lays_one_channel_after_another_over_every_plot_and_then_none() -> None:
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45)) as here:
        await here.press("i")
        await here.until(lambda: "modes" in here.words("#whole-modes"))
        plot = here.app.screen.query_one("#whole-q", Plot)
        said = []
        for _ in range(5):
            await here.press("l")
            said.append((str(here.app.screen.query_one("WholeFlightPane").border_subtitle), plot.chart.layer))
    assert said[0][0] == "-5.73 to 5.73 deg: δe laid over; l: next"
    assert all(layer is not None for _, layer in said[:4])
    assert said[4] == ("l: lay a channel over", None)
    assert plot.chart.series[0].y.max() == pytest.approx(5.7296, abs=1e-3)
