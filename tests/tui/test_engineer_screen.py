"""Every number behind the word, and what an engineer does by hand."""

import pytest
from textual.containers import VerticalScroll
from textual.widgets import DataTable, Input

from advisor.tui.panes.courses import Criterion
from advisor.tui.panes.fit import Fit
from advisor.tui.panes.live import Live
from advisor.tui.panes.parameters import ParametersPane
from advisor.tui.plot.painting import Plot
from advisor.tui.settings import Settings
from tests.campaign.states import changed
from tests.tui import flights
from tests.tui.stage import Stage, stage
from tests.tui.stand_ins import HandFedSource

ENGINEER = Settings(screen="engineer")
WIDE = (200, 60)


def table(here: Stage, pane: str) -> list[list[str]]:
    """The cells of a pane's table."""
    rows = here.app.screen.query_one(f"{pane} DataTable", DataTable)
    return [[str(cell) for cell in rows.get_row_at(k)] for k in range(rows.row_count)]


async def filled(here: Stage, count: int) -> None:
    await here.until(lambda: len(table(here, "Maneuvers")) == count)


async def test_the_table_shows_each_manoeuvre_with_what_every_rule_says():
    async with stage(flights.state(4), settings=ENGINEER, size=(80, 24)) as here:
        await filled(here, 4)
        rows = table(here, "Maneuvers")
        assert rows[0][:4] == ["1", "1:45.0", "3-2-1-1", "✓ ACCEPTED"]
        assert (rows[1][3], rows[1][5]) == ("✗ REJECTED", "amplitude, bank")
        assert rows[3][4] == "✓✗✓"


@pytest.mark.parametrize("size", [(80, 24), (110, 30), (200, 60)], ids=str)
async def test_no_reason_and_no_time_is_cut_in_the_table_at_any_size(size: tuple[int, int]):
    async with stage(flights.state(4), settings=ENGINEER, size=size) as here:
        await filled(here, 4)
        row = table(here, "Maneuvers")[1]
        assert row[-1] in ("amplitude, bank", "amplitude +1")
        shown = next(line for line in here.page().split("\n") if "2:10.0" in line)
        assert f"{row[-1]} " in shown.replace("┃", "│").split("│")[1]


async def test_the_eight_parameters_stand_with_intervals_beside_the_prior_model_and_open_on_the_stability():
    async with stage(flights.state(4), settings=ENGINEER, size=WIDE) as here:
        await here.until(lambda: len(table(here, "ParametersPane")) == 8)
        rows = {row[0].split()[0]: row[1:] for row in table(here, "ParametersPane")}
        assert set(rows) == {"Z_0", "Z_α", "Z_q", "Z_δe", "M_0", "M_α", "M_q", "M_δe"}
        assert rows["M_α"][0].startswith("−4")
        assert " ± 3.7" in rows["M_α"][0]
        assert rows["M_α"][2] == "−52.8"
        assert rows["M_α"][3].endswith("σ")
        assert rows["Z_q"][:2] == ["not identifiable", "not identifiable"]  # no number for what is not told
        plot = here.app.screen.query_one(ParametersPane).query_one(Plot)
        await here.until(lambda: plot.chart.y_label.startswith("M_α"))


@pytest.mark.parametrize(("size", "columns"), [((110, 30), 3), ((140, 45), 5)], ids=str)
async def test_no_number_of_the_parameters_is_cut(size: tuple[int, int], columns: int):
    async with stage(flights.state(2), settings=ENGINEER, size=size) as here:
        await here.until(lambda: len(table(here, "ParametersPane")) == 8)
        rows = here.app.screen.query_one("ParametersPane DataTable", DataTable)
        assert len(rows.columns) == columns
        assert rows.virtual_size.width <= rows.size.width


async def test_the_last_row_follows_the_newest_manoeuvre_and_another_that_was_selected_stays():
    source = HandFedSource()
    states = (flights.state(count) for count in (3, 4, 5))
    async with stage(*states, settings=ENGINEER, size=WIDE, source=source) as here:
        await filled(here, 3)
        source.deliver()
        await filled(here, 4)
        fit = here.app.screen.query_one(Fit)
        assert fit.border_subtitle == "manoeuvre 4"
        await here.press("up", "up", "up")
        assert fit.border_subtitle == "manoeuvre 1"
        source.deliver()
        await filled(here, 5)
        assert fit.border_subtitle == "manoeuvre 1"


async def test_every_output_is_plotted_in_its_unit_with_its_residual():
    async with stage(flights.state(2), settings=ENGINEER, size=WIDE) as here:
        await filled(here, 2)
        plots = here.app.screen.query_one(Fit).query(Plot)
        elevator, *charts = (plot.chart for plot in plots if plot.display)
        assert elevator.y_label == "δe [deg]"
        assert [c.y_label for c in charts[::2]] == ["α [deg]", "q [deg/s]", "a_z [m/s²]", "θ [deg]"]
        assert all([s.name for s in c.series] == ["measured", "fitted"] for c in charts[::2])
        assert all([s.name for s in c.series] == ["residual"] for c in charts[1::2])


async def test_the_manoeuvre_in_the_air_is_traced_as_it_is_flown():
    async with stage(flights.state(2, in_the_air=True), settings=ENGINEER, size=WIDE) as here:
        live = here.app.screen.query_one(Live)
        await here.until(lambda: live.border_subtitle == "in the air: manoeuvre 3")
        assert here.words("#progress").startswith("flown ")
        assert [s.name for s in live.query_one("#live-q", Plot).chart.series] == ["measured"]


async def test_all_rules_are_plotted_each_as_a_share_of_its_limit():
    async with stage(flights.state(7), settings=ENGINEER, size=WIDE) as here:
        await filled(here, 7)
        chart = here.app.screen.query_one(Criterion).query_one(Plot).chart
        assert [s.name for s in chart.series] == ["continuous", "separate", "information"]
        assert chart.levels[0].y == 100.0
        assert "► continuous" in here.words("Criterion Lines")


async def test_excluding_asks_for_a_reason_and_records_it():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        await filled(here, 3)
        await here.press("up", "x")
        assert isinstance(here.app.focused, Input)
        await here.press(*"gust", "enter")
        await here.until(lambda: ("exclude", 2, "gust") in here.campaign.calls)
        await here.until(lambda: table(here, "Maneuvers")[1][3::2] == ["∅ EXCLUDED", "gust"])
        await here.press("x", *"fine", "enter")
        await here.until(lambda: ("include", 2) in here.campaign.calls)
        await here.until(lambda: ("note", 2, "included again: fine") in here.campaign.calls)


async def test_a_decision_by_hand_is_acknowledged_before_it_is_computed(monkeypatch: pytest.MonkeyPatch):
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        await filled(here, 3)
        said: list[str] = []
        monkeypatch.setattr(here.app.screen, "say", said.append)
        monkeypatch.setattr(here.app.conductor, "decide", lambda decision: None)
        await here.press("up", "x", *"gust", "enter")
        assert said == ["exclude manoeuvre 2: all verdicts are computed again"]


async def test_a_question_moves_no_pane_and_an_exclusion_without_a_reason_is_not_made():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        await filled(here, 3)
        before = [widget.region for widget in here.app.screen.query("Pane, Plot")]
        await here.press("n")
        assert isinstance(here.app.focused, Input)
        assert [widget.region for widget in here.app.screen.query("Pane, Plot")] == before
        await here.press("escape", "x", "enter")
        assert isinstance(here.app.focused, Input)
        await here.press("escape")
        assert here.campaign.calls == []


async def test_texts_take_the_keys_that_scroll_them():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        for pane in "2", "7", "8":
            await here.press(pane)
            assert isinstance(here.app.focused, VerticalScroll), pane


async def test_notes_and_marks_reach_the_campaign():
    async with stage(flights.state(3), settings=ENGINEER, size=(80, 24)) as here:
        await filled(here, 3)
        await here.press("n", *"hm", "enter", "m", *"flaps", "enter")
        await here.until(lambda: ("note", 3, "hm") in here.campaign.calls)
        await here.until(lambda: ("mark", "flaps") in here.campaign.calls)


async def test_the_parameter_under_the_cursor_has_its_history_drawn():
    async with stage(flights.state(5), settings=ENGINEER, size=WIDE) as here:
        await filled(here, 5)
        await here.press("3", "down", "down")
        chart = here.app.screen.query_one(ParametersPane).query_one(Plot).chart
        assert chart.y_label == "M_δe [1/s²]"
        assert [level.name for level in chart.levels] == ["joint", "simulator"]


async def test_a_manoeuvre_without_an_estimate_says_why():
    state = flights.state(2)
    failed = (*state.maneuvers, flights.without_estimate(3))
    async with stage(changed(state, maneuvers=failed), settings=ENGINEER, size=WIDE) as here:
        await filled(here, 3)
        assert "no estimate: The input did not move the aircraft." in here.words("VerdictPane Lines")
        assert "The input did not move" in here.app.screen.query_one("#fit-q", Plot).chart.why_empty


async def test_the_log_tells_of_the_campaign_and_of_the_link_in_order():
    source = HandFedSource()
    async with stage(flights.state(1), flights.state(2), settings=ENGINEER, size=WIDE, source=source) as here:
        await here.until(lambda: "manoeuvre 1 judged" in here.words("EventLogPane Lines"))
        source.notices.append("reconnected after 3 s")
        await here.until(lambda: "link: reconnected" in here.words("EventLogPane Lines"))
        source.deliver()
        await here.until(lambda: "manoeuvre 2 judged" in here.words("EventLogPane Lines"))
        lines = here.words("EventLogPane Lines").split("\n")
        assert [line[9:].split()[0] for line in lines] == ["following", "manoeuvre", "link:", "manoeuvre"]
        assert [line[:7].strip() for line in lines] == ["–", "1:53.0", "–", "2:18.0"]
