"""A chart on cells: the stretch that is shown, the cursor's readings, what is left away."""

import numpy as np
import pytest
from rich.style import Style

from advisor.tui.plot.chart import INKS, Chart, Level, Series
from advisor.tui.plot.painting import Painting, paint

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
