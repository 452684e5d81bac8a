"""Residuals, correlation and history: each shows what its estimate holds, and nothing else."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from rich.text import Text

from advisor.aircraft.reference import PARAMETERS
from advisor.campaign.state import CampaignState
from advisor.session.conducting import View, view_before_first
from advisor.tui.panes.correlation import Correlation
from advisor.tui.panes.courses import Courses, Criterion, course, history_chart
from advisor.tui.panes.residuals import Residuals
from advisor.tui.plot.painting import Plot
from advisor.tui.screens.engineer import PANES
from advisor.tui.settings import Settings
from tests.campaign.states import changed
from tests.tui import flights
from tests.tui.stage import Stage, stage
from tests.tui.stand_ins import HandFedSource

ENGINEER = Settings(screen="engineer")


def view(state: CampaignState) -> View:
    return replace(view_before_first(flights.AIRCRAFT, "x", None), state=state)


def matrix(here: Stage) -> str:
    text = here.app.screen.query_one(Correlation).query_one("#matrix").render()
    return text.plain if isinstance(text, Text) else str(text)


def test_a_course_holds_each_manoeuvre_that_tells_the_parameter():
    state = flights.state(4)
    of = course(view(state), "M_alpha")
    k = PARAMETERS.index("M_alpha")
    assert of.numbers.tolist() == [1.0, 2.0, 3.0, 4.0]
    assert of.value.tolist() == [j.estimate.theta[k] for j in state.maneuvers]
    assert of.half == pytest.approx(1.959964 * flights.SPREAD[k])
    assert of.model == state.model.theta[k]
    assert of.prior == pytest.approx(1.1 * flights.TRUTH[k])


def test_a_parameter_that_no_manoeuvre_tells_has_no_course():
    assert len(course(view(flights.state(4)), "Z_q").numbers) == 0
    assert "no manoeuvre has given an estimate" in history_chart(view(flights.state(4)), "Z_q").why_empty


def test_the_joint_estimate_is_a_solid_line_and_the_prior_a_dashed_one():
    levels = history_chart(view(flights.state(4)), "M_q").levels
    assert [(level.name, level.dashed) for level in levels] == [("joint", False), ("simulator", True)]


async def test_the_history_numbers_the_manoeuvres_below_the_lowest_plots_only():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        await here.press("h")
        plots = list(here.app.screen.query_one(Courses).query(Plot))
        assert [plot.chart.foot for plot in plots] == [False] * 4 + [True] * 4
        assert plots[-1].render_line(plots[-1].size.height - 1).text.split() == ["1", "2", "3"]


async def test_the_joint_correlation_stands_above_the_diagonal_and_the_manoeuvres_below():
    state = flights.state(2)
    i, j = PARAMETERS.index("Z_alpha"), PARAMETERS.index("M_q")
    joint = np.diag(flights.SPREAD**2)
    joint[i, j] = joint[j, i] = 0.95 * flights.SPREAD[i] * flights.SPREAD[j]
    correlated = changed(state, model=replace(state.model, covariance=joint))
    async with stage(correlated, settings=ENGINEER, size=(80, 24)) as here:
        await here.press("0")
        lines = matrix(here).split("\n")
        assert lines[0] == "above the diagonal: joint estimate; below: manoeuvre 2"
        assert lines[2 + i].split()[1 + j] == "0.95"
        assert lines[2 + j].split()[1 + i] == "0.00"
        assert lines[-1] == "joint: Z_α and M_q 0.950"


async def test_a_pane_in_sight_takes_the_next_estimates():
    counts = (2, *(count for _ in PANES for count in (2, 3)))
    states = [pickle.loads(pickle.dumps(flights.state(count))) for count in counts]  # new objects each
    source = HandFedSource()
    async with stage(*states, settings=ENGINEER, size=(80, 24), source=source) as here:
        for k, state in enumerate(states[1:]):
            pane = PANES[k // 2]
            if k % 2 == 0:
                await here.press(pane.TITLE[0])
            source.deliver()
            await here.until(lambda state=state: here.app.view.state.model is state.model)
            assert here.app.is_running, pane
            assert here.app.screen.query_one(pane).display, pane


async def test_correlations_are_written_again_for_a_new_estimate_alone(monkeypatch: pytest.MonkeyPatch):
    async with stage(flights.state(2), settings=ENGINEER, size=(80, 24)) as here:
        await here.press("0")
        pane, written = here.app.screen.query_one(Correlation), list[None]()
        monkeypatch.setattr(pane, "_redraw", lambda: written.append(None))
        now = view(here.app.view.state)
        pane.show(now)
        assert len(written) == 0
        pane.show(view(pickle.loads(pickle.dumps(now.state))))
        assert len(written) == 1


async def test_a_parameter_without_variance_has_no_correlation_on_the_screen():
    state = flights.state(2)
    model = replace(state.model, covariance=np.diag(np.r_[0.0, flights.SPREAD[1:] ** 2]))
    async with stage(changed(state, model=model), settings=ENGINEER, size=(80, 24)) as here:
        await here.press("0")
        assert matrix(here).split("\n")[2].split()[:3] == ["Z_0", "1", "-"]


async def test_only_outputs_of_the_fit_have_residuals():
    state = flights.state(1)
    judged = flights.judged(1, outputs=("q", "a_z"))
    async with stage(changed(state, maneuvers=(judged,)), settings=ENGINEER, size=(80, 24)) as here:
        await here.press("9")
        pane = here.app.screen.query_one(Residuals)
        await here.until(lambda: pane.border_subtitle is not None)
        assert [plot.id for plot in pane.query(Plot) if plot.display] == ["white-q", "white-a_z"]


async def test_a_manoeuvre_without_an_estimate_has_no_residuals_and_says_why():
    state = flights.state(1)
    without = changed(state, maneuvers=(flights.without_estimate(1),))
    async with stage(without, settings=ENGINEER, size=(80, 24)) as here:
        await here.press("9")
        plots = [plot for plot in here.app.screen.query_one(Residuals).query(Plot) if plot.display]
        assert [plot.chart.why_empty for plot in plots] == ["The input did not move the aircraft."]
        await here.press("0")
        assert "manoeuvre 1, which has no estimate" in matrix(here)


async def test_a_fit_without_room_for_a_residual_keeps_its_time_axis():
    async with stage(flights.state(2), settings=ENGINEER, size=(80, 21)) as here:
        await here.press("4")
        fit = here.app.screen.query_one("#fit-alpha", Plot)
        assert fit.chart.foot
        assert not here.app.screen.query_one("#residual-alpha").display


async def test_the_lines_and_the_curves_of_the_criterion_have_one_scale_and_the_deciding_rule_is_first():
    async with stage(flights.state(4), settings=ENGINEER, size=(140, 45)) as here:
        await here.press("6")
        pane = here.app.screen.query_one(Criterion)
        series = pane.query_one(Plot).chart.series
        assert [one.name for one in series] == ["continuous", "separate", "information"]
        lines = [line.split() for line in here.words("Criterion HangingLines").splitlines()]
        for one in series:
            (line,) = [words for words in lines if one.name in words]
            assert f"{float(one.y[-1]):.0f} % of its limit" in " ".join(line)
