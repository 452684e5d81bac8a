"""A chart on cells: the stretch that is shown, the cursor's readings, what is left away."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.style import Style

from advisor.tui.plot.axis import Axis, exact_axis, log_axis, round_axis
from advisor.tui.plot.chart import INKS, Chart, Level, Series
from advisor.tui.plot.painting import Painting, along_the_foot, down_the_side, paint, whole

X = np.arange(0.0, 10.01, 0.1)
RAMP = Series("ramp", X, 2.0 * X, "measured")
STYLES = [Style() for _ in INKS]


def painted(chart: Chart, width: int = 60, height: int = 12) -> Painting:
    return paint(chart, width, height, Style(), STYLES)


def lines(painting: Painting) -> list[str]:
    return [strip.text for strip in painting.strips]


def test_the_cursor_reads_the_sample_nearest_to_it():
    chart = Chart("y [m]", "t [s]", (RAMP,), x_range=(0.0, 10.0), cursor=2.53)
    assert lines(painted(chart))[0].startswith("y [m]  ── ramp 5.00")


def test_a_curve_without_a_sample_near_the_cursor_reads_nothing():
    short = Series("short", X[:11], X[:11], "fitted")
    chart = Chart("y [m]", "t [s]", (RAMP, short), x_range=(0.0, 10.0), cursor=5.0)
    assert lines(painted(chart))[0].rstrip() == "y [m]  ── ramp 10.00  ── short"


def test_the_y_axis_holds_what_is_in_the_stretch_that_is_shown():
    whole = painted(Chart("y [m]", "t [s]", (RAMP,), x_range=(0.0, 10.0)))
    part = painted(Chart("y [m]", "t [s]", (RAMP,), x_range=(1.0, 2.0)))
    assert "20" in "".join(line[:5] for line in lines(whole))
    assert "20" not in "".join(line[:5] for line in lines(part))


def test_a_line_runs_to_both_edges_of_the_stretch_that_is_shown():
    rows = lines(painted(Chart("y [m]", "t [s]", (RAMP,), x_range=(1.03, 1.97), gutter=7)))[1:-1]
    assert any(len(row) > 7 and row[7] != " " for row in rows)
    assert any(row[-1] != " " for row in rows)


def test_the_column_of_a_value_is_the_value_of_the_column():
    painting = painted(Chart("y [m]", "t [s]", (RAMP,), x_range=(0.0, 10.0), gutter=10))
    assert painting.x_at(10, 60) == pytest.approx(0.0)
    assert painting.x_at(59, 60) == pytest.approx(10.0)
    assert painting.x_at(3, 60) == pytest.approx(0.0)


def test_a_plot_above_another_one_has_no_labels_at_its_foot():
    above, lowest = (painted(Chart("y [m]", "t [s]", (RAMP,), foot=foot)) for foot in (False, True))
    assert "t [s]" not in "".join(lines(above))
    assert lines(lowest)[-1].endswith("t [s]")
    assert len(above.strips) == len(lowest.strips)


def test_plots_with_one_gutter_begin_in_one_column():
    small, large = (
        painted(Chart("y [m]", "t [s]", (Series("", X, size * X, "fitted"),), gutter=8))
        for size in (1.0, 1e4)
    )
    assert small.gutter == large.gutter == 8


def test_the_axis_holds_whole_intervals():
    series = Series(
        "value", np.array([1.0, 2.0]), np.array([5.0, 6.0]), "measured", "intervals", np.full(2, 4.0)
    )
    side = "".join(line[:6] for line in lines(painted(Chart("y", "manoeuvre", (series,), whole_x=True))))
    assert "10" in side


def test_what_has_no_name_is_not_in_the_legend():
    chart = Chart("y [m]", "t [s]", (Series("", X, X, "fitted"),), (Level("", 1.0), Level("limit", 2.0)))
    assert lines(painted(chart))[0].rstrip() == "y [m]  ╌╌ limit"


values = st.lists(st.floats(-1e9, 1e9), min_size=1, max_size=8)


@given(values, st.integers(1, 12))
def test_an_axis_holds_its_data_and_has_at_least_two_ticks(data: list[float], intervals: int):
    axis = round_axis([np.array(data)], intervals)
    slack = 1e-6 * (axis.high - axis.low)
    assert axis.low - slack <= min(data)
    assert max(data) <= axis.high + slack
    # The next finer step than one with a single tick, at 0, may have two more on either side.
    assert 2 <= len(axis.ticks) <= max(intervals + 3, 5)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e6), st.integers(1, 12))
def test_an_exact_axis_keeps_its_ends_and_has_three_ticks(low: float, length: float, intervals: int):
    axis = exact_axis(low, low + length, intervals)
    assert (axis.low, axis.high) == (low, low + length)
    assert 3 <= len(axis.ticks) <= max(intervals + 2, 8)


@pytest.mark.parametrize("empty", [[], [np.array([])], [np.array([np.nan, np.inf])]])
def test_without_finite_data_the_axis_goes_from_0_to_1(empty: list[np.ndarray]):
    axis = round_axis(empty, 4)
    assert (axis.low, axis.high) == (0.0, 1.0)


def test_a_constant_gets_room_around_it():
    axis = round_axis([np.full(5, -9.81)], 3)
    assert axis.low < -9.81 < axis.high


def test_labels_have_the_decimals_of_the_step():
    assert Axis(0.0, 1.0, 0.5).labels == ["0.0", "0.5", "1.0"]
    assert Axis(-20.0, 20.0, 20.0).labels == ["-20", "0", "20"]


def test_growing_data_do_not_move_the_axis_until_they_need_to():
    axes = {round_axis([np.linspace(0.0, end, 50)], 4) for end in np.linspace(5.0, 10.0, 100)}
    assert len(axes) <= 7


def test_counts_have_ticks_at_whole_numbers():
    axis = whole(round_axis([np.array([1.0, 2.0, 3.0])], 12))
    assert all(tick == int(tick) for tick in axis.ticks)


def test_the_side_names_each_tick_at_its_height():
    assert down_the_side(Axis(0.0, 10.0, 5.0), 3, 4) == [" 10 ", "  5 ", "  0 "]


@given(st.integers(16, 200))
def test_the_foot_keeps_to_its_width_and_ends_with_the_unit(width: int):
    foot = along_the_foot(Axis(0.0, 100.0, 5.0), "t [s]", 4, width)
    assert len(foot) == width
    assert foot.endswith("t [s]")


def test_a_logarithmic_axis_reads_at_25_and_at_2500():
    axis = log_axis([np.array([25.0, 2500.0])], 8)
    assert axis.labels == ["20", "50", "100", "200", "500", "1,000", "2,000", "5,000"]
    assert 10.0**axis.low <= 25.0 < 2500.0 <= 10.0**axis.high


def test_a_logarithmic_axis_without_room_keeps_powers_of_ten():
    assert log_axis([np.array([25.0, 2500.0])], 3).labels == ["100", "1,000"]


@pytest.mark.parametrize("values", [[], [0.0, -3.0], [np.nan], [100.0], [3.0, 1e7]])
@pytest.mark.parametrize("most", [2, 4, 9])
def test_a_logarithmic_axis_has_two_ticks_or_more_within_its_ends(values: list[float], most: int):
    axis = log_axis([np.array(values)], most)
    assert len(axis.ticks) >= 2
    assert axis.low - 1e-9 <= axis.ticks[0] < axis.ticks[-1] <= axis.high + 1e-9
