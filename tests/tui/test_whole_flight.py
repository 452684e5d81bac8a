"""The pane of the whole flight."""

from dataclasses import replace

import pytest

from advisor.session.conducting import Playback
from advisor.session.replay import LogPlayer
from advisor.tui.plot.painting import Plot
from advisor.tui.settings import Settings
from tests.campaign.side_builders import judged as side_judged
from tests.campaign.side_builders import state as side_state
from tests.campaign.states import changed
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


async def test_a_click_goes_to_the_manoeuvre_there_of_either_axis_or_else_to_the_time(monkeypatch):
    player = LogPlayer("a.tlog", lambda: [columns(range(20000), [k / 50.0 for k in range(20000)])])
    playback = Playback(300.0, 400.0)
    # Every later report has this playback too, so no report replaces it between two clicks.
    monkeypatch.setattr(player, "playback", lambda: playback)
    state = flights.state(4)
    second = state.maneuvers[1].maneuver.span
    turn = side_judged(1, "aileron")
    span = replace(turn.maneuver.span, start_s=second.end_s + 2.0, end_s=second.end_s + 5.0)
    side = side_state(replace(turn, maneuver=replace(turn.maneuver, span=span)))
    state = changed(state, lateral=side)
    async with stage(state, settings=ENGINEER, size=(140, 45), source=player) as here:
        await here.press("i")
        await here.until(lambda: "2✗" in here.words("#whole-maneuvers"))
        app = here.app
        await here.until(lambda: app.view.playback == playback)
        asked: list[float] = []
        monkeypatch.setattr(app, "seek", asked.append)
        plot = app.screen.query_one("#whole-q", Plot)
        for at_s in (second.start_s + 1.0, span.start_s + 1.0, span.end_s + 1.0):
            plot.post_message(Plot.Pointed(at_s))
        await here.until(lambda: len(asked) == 3)
    times = [second.start_s, span.start_s, span.end_s + 1.0]
    assert asked == pytest.approx([300.0 + t - state.now_s for t in times])


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


async def test_roll_and_yaw_have_their_own_channels_in_the_same_places() -> None:
    state = flights.state(4)
    whole = state.whole_flight
    courses = {**whole.courses, "aileron": whole.courses["elevator"], "p": whole.courses["q"]}
    state = changed(
        state, whole_flight=replace(whole, courses=courses), lateral=side_state(side_judged(1, "aileron"))
    )
    async with stage(state, settings=ENGINEER, size=(140, 45)) as here:
        await here.press("i", "r")
        first = here.app.screen.query_one("#whole-elevator", Plot)
        await here.until(lambda: first.chart.y_label == "δa [deg]")
        assert first.chart.series[0].y.max() == pytest.approx(5.7296, abs=1e-3)
        assert here.app.screen.query_one("#whole-q", Plot).chart.y_label == "p [deg/s]"
        assert here.words("#whole-maneuvers").split() == ["1✓", "2✗", "3✓", "4✓"]
        await here.press("r")
        await here.until(lambda: first.chart.y_label == "δe [deg]")
