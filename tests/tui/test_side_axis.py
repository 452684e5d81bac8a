"""Roll and yaw on both screens: the axis is switched by a key."""

import numpy as np

from advisor.campaign.state import HandDecision
from advisor.decision.inputs import StepInput
from advisor.decision.verdict import NextInput
from advisor.session.conducting import view_sideways
from advisor.tui.advice import advise
from advisor.tui.settings import Settings
from advisor.tui.stick_drawing import drawn
from tests.campaign.side_builders import judged, state
from tests.campaign.states import changed
from tests.tui import flights
from tests.tui.stage import stage
from tests.tui.test_pilot_screen import view


def both_axes(*side):
    return changed(flights.state(3), lateral=state(*side))


async def test_the_key_shows_the_verdict_on_aileron_and_rudder_and_then_the_elevator_again():
    flown = both_axes(judged(1, "aileron"), judged(2, "rudder", accepted=False))
    async with stage(flown, size=(100, 35)) as here:
        await here.until(lambda: "roll, yaw" in here.words("CrewNotes"))
        assert "roll, yaw   CONTINUE; key r shows roll and yaw" in here.words("CrewNotes")
        assert "reverse 3-2-1-1" in here.words("NextInput")
        await here.press("r")
        assert "✗ REPEAT   manoeuvre 2: rudder doublet" in here.words()
        assert "key r shows the elevator's" in here.words("CrewNotes")
        assert "reverse 3-2-1-1" in here.words("NextInput")
        await here.press("r")
        assert "manoeuvre 2: rudder doublet" not in here.words()


def test_the_test_is_complete_when_both_axes_are():
    pitch_is_known = changed(flights.state(7), lateral=state(judged(1, "aileron")))
    for shown in (view(pitch_is_known), view_sideways(view(pitch_is_known))):
        assert advise(shown).word == "CONTINUE"
        assert shown.plan is not None
        assert "rudder" in shown.plan.advice
    assert advise(view(pitch_is_known)).sentence == "Pitch is complete, roll and yaw are open."


async def test_the_fit_has_the_control_that_moved_and_the_outputs_of_the_axis():
    async with stage(
        both_axes(judged(1, "aileron"), judged(2, "rudder")),
        size=(180, 80),
        settings=Settings(screen="engineer"),
    ) as here:
        await here.until(lambda: here.app.screen.query_one("Maneuvers DataTable").row_count == 3)
        await here.press("r")
        await here.until(lambda: here.app.screen.query_one("Maneuvers DataTable").row_count == 2)
        shown = [plot.id for plot in here.app.screen.query("Fit Plot") if plot.display]
        assert shown[:2] == ["fit-rudder", "fit-p"]
        assert not any("elevator" in name or "alpha" in name for name in shown)
        assert "δr [deg]" in here.page()


async def test_the_parameters_are_those_of_the_axis_and_a_pane_of_the_elevator_alone_says_so():
    async with stage(
        both_axes(judged(1, "aileron"), judged(2, "rudder")),
        size=(180, 80),
        settings=Settings(screen="engineer"),
    ) as here:
        table = here.app.screen.query_one("ParametersPane DataTable")
        await here.until(lambda: table.row_count == 8)
        await here.press("r", "h")
        await here.until(lambda: table.row_count == 15)
        rows = {str(table.get_row_at(k)[0]): str(table.get_row_at(k)[1]).strip() for k in range(15)}
        assert rows["L_p 1/s"] == "−2.100 ± 0.082"
        assert here.app.screen.query_one("ParametersPane Plot").chart.y_label == "L_p [1/s]"
        titles = [str(here.app.screen.query_one(name).border_title) for name in ("Courses", "ParametersPane")]
        assert titles == ["h History (elevator)", "3 Parameters"]
        await here.press("r")
        await here.until(lambda: table.row_count == 8)
        assert here.app.screen.query_one("Courses").border_title == "h History"


async def test_an_exclusion_by_hand_concerns_the_axis_that_is_shown(monkeypatch):
    async with stage(
        both_axes(judged(1, "aileron")), size=(120, 40), settings=Settings(screen="engineer")
    ) as here:
        decided = []
        monkeypatch.setattr(here.app.conductor, "decide", decided.append)
        await here.press("r", "x", *"gust", "enter")
        await here.until(lambda: decided)
        assert decided == [HandDecision("exclude", "gust", 1, "lateral")]


async def test_the_flying_qualities_are_those_of_the_axis_that_is_shown():
    async with stage(
        both_axes(judged(1, "aileron")), size=(120, 60), settings=Settings(screen="engineer")
    ) as here:
        await here.press("u", "r")
        await here.until(lambda: "Dutch roll ω" in here.words("Qualities HangingLines"))
        assert "Category B: Level" in here.words("Qualities HangingLines")
        await here.press("r")
        await here.until(lambda: "Dutch roll" not in here.words("Qualities HangingLines"))


def test_equal_states_give_identical_parts_so_that_nothing_is_painted_again():
    now = view(both_axes(judged(1, "aileron")))
    first, second = view_sideways(now), view_sideways(now)
    assert first.state.maneuvers is second.state.maneuvers
    assert first.state.model is second.state.model
    assert first.elevator is now


def test_a_lateral_input_is_drawn_with_right_above_and_left_below():
    flown = StepInput("doublet", 1.0, np.radians(10.0), nose_up_first=True, control="aileron")
    advised = NextInput(f"next: {flown.spoken(np.radians(25.0))}", None, None, flown)
    first, second, *lines = drawn(advised, 60, large=True).split("\n")
    said = " ".join(f"{first}{second}".split())
    assert max(len(first), len(second)) <= 60
    assert said == "next aileron doublet, 1.0 s steps, 40 % stick, ±10.0 deg of aileron"
    assert [line.split()[0] for line in (lines[0], lines[2])] == ["right", "left"]
    assert drawn(advised, 60, large=False).endswith("▔▔▁▁  right first")


async def test_the_screen_opens_on_roll_and_yaw_where_only_they_are_flown_and_counts_them():
    flown = changed(flights.state(0), lateral=state(judged(1, "aileron"), judged(2, "aileron")))
    async with stage(flown, size=(100, 35)) as here:
        await here.until(lambda: "accepted so far" in here.words("Gauge"))
        assert "2 accepted so far" in here.words("Gauge")
        assert "2 accepted of 2" in here.words("Gauge")
        await here.press("r")
        assert "none flown yet" in here.words("Gauge")


async def test_an_axis_without_a_manoeuvre_does_not_keep_the_verdict_of_the_other():
    async with stage(changed(flights.state(3), lateral=state()), size=(100, 35)) as here:
        await here.until(lambda: "GOOD" in here.words("#verdict-word"))
        await here.press("r")
        assert here.words("#verdict-word") == "no manoeuvre yet"
        assert not here.app.screen.query_one("LastVerdict").has_class("-good")


async def test_no_word_of_the_next_input_is_cut_at_80_by_24():
    async with stage(changed(flights.state(3), lateral=state()), size=(80, 24)) as here:
        await here.press("r")
        page = " ".join(here.page().split())
        assert " ".join(here.words("NextInput").split()) in page
        assert "…" not in here.words("NextInput")
