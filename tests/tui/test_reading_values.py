"""An engineer reads values off the fit, zooms into it, and lays another manoeuvre over it."""

from textual.events import MouseScrollUp

from advisor.tui.panes.fit import Fit
from advisor.tui.plot.painting import Plot
from advisor.tui.settings import Settings
from tests.tui import flights
from tests.tui.stage import Stage, stage

ENGINEER = Settings(screen="engineer")


def legend(here: Stage, name: str) -> str:
    return here.app.screen.query_one(f"#{name}", Plot).render_line(0).text.rstrip()


async def fit_of(here: Stage, manoeuvre: int) -> Fit:
    fit = here.app.screen.query_one(Fit)
    await here.press("4")
    await here.until(lambda: str(fit.border_subtitle).startswith(f"manoeuvre {manoeuvre}"))
    return fit


def shown(fit: Fit) -> tuple[float, float]:
    window = fit.query_one("#fit-elevator", Plot).chart.x_range
    assert window is not None
    return window


async def test_the_keys_move_a_cursor_that_reads_every_curve():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        fit = await fit_of(here, 3)
        assert legend(here, "fit-alpha") == "α [deg]  ∙∙ measured  ── fitted"
        await here.press("right", *["shift+right"] * 10)
        assert fit.border_subtitle == "t 0.200 s  manoeuvre 3"
        assert legend(here, "fit-elevator") == "δe [deg]  ── elevator 2.000"
        judged = flights.judged(3).estimate.fits[0]["alpha"]
        measured = f"{57.29578 * judged.measured[110]:.2f}"
        assert legend(here, "fit-alpha").startswith(f"α [deg]  ∙∙ measured {measured}  ── fitted ")
        assert "residual " in legend(here, "residual-alpha")


async def test_the_plots_of_the_fit_stand_over_one_time_axis():
    async with stage(flights.state(3), settings=ENGINEER, size=(200, 60)) as here:
        fit = await fit_of(here, 3)
        plots = [plot for plot in fit.query(Plot) if plot.display]
        assert [plot.id for plot in plots[:3]] == ["fit-elevator", "fit-alpha", "residual-alpha"]
        assert len({plot.chart.x_range for plot in plots}) == 1
        assert [plot.chart.foot for plot in plots] == [False] * (len(plots) - 1) + [True]


async def test_a_click_sets_the_cursor_and_the_wheel_zooms_about_the_mouse():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        fit = await fit_of(here, 3)
        await here.pilot.click("#fit-alpha", offset=(75, 2))
        assert fit.border_subtitle == "t 7.980 s  manoeuvre 3"
        plot = here.app.screen.query_one("#fit-alpha", Plot)
        plot.post_message(
            MouseScrollUp(
                plot, x=75, y=1, delta_x=0, delta_y=0, button=0, shift=False, meta=False, ctrl=False
            )
        )
        await here.until(lambda: shown(fit) != (-2.0, 8.0))
        assert abs(shown(fit)[1] - 8.0) < 0.1
        assert "w: whole record" in str(fit.border_subtitle)


async def test_the_keys_zoom_pan_and_show_everything_again():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        fit = await fit_of(here, 3)
        whole = shown(fit)
        await here.press("z", "up")
        low, high = shown(fit)
        assert high - low < 0.5 * (whole[1] - whole[0])
        await here.press("greater_than_sign")
        assert shown(fit)[0] > low
        await here.press("less_than_sign", "less_than_sign")
        assert shown(fit)[0] < low
        await here.press("right", "w")
        assert shown(fit) == whole
        assert fit.border_subtitle == "manoeuvre 3"


async def test_a_second_manoeuvre_is_laid_over_and_taken_away_again():
    async with stage(flights.state(4), settings=ENGINEER, size=(120, 40)) as here:
        fit = await fit_of(here, 4)
        await here.press("l", "1", "enter")
        assert fit.border_subtitle == "manoeuvres 4 and 1"
        assert str(fit.border_title).startswith("4 Fit  both start at the first step of the input")
        assert legend(here, "fit-alpha") == "α [deg]  ── measured 1  ∙∙ measured 4"
        await here.press("l", "9", "enter")
        assert "Choose another manoeuvre than 4, from 1 to 4." in here.page()
        await here.press("l", "0", "enter")
        assert fit.border_subtitle == "manoeuvre 4"


async def test_the_four_panes_of_the_middle_share_one_place_on_a_wide_terminal():
    async with stage(flights.state(3), settings=ENGINEER, size=(200, 60)) as here:
        for key, name in (("9", "Residuals"), ("0", "Correlation"), ("h", "Courses"), ("4", "Fit")):
            await here.press(key, "6")
            middle = [type(p).__name__ for p in here.app.screen.query("#middle Pane") if p.display]
            assert middle == [name]
