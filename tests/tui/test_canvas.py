"""The braille canvas against dots placed by hand and properties that any drawing has."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from advisor.tui.plot.painting import BLANK, Canvas


def dots(canvas: Canvas) -> int:
    """How many dots are set in all."""
    return sum((ord(c) - BLANK).bit_count() for row in canvas.text() for c in row if c != " ")


def test_an_empty_canvas_is_blank():
    assert Canvas(3, 2, (0.0, 1.0), (0.0, 1.0)).text() == ["   ", "   "]


def test_the_corners_of_the_data_are_the_corners_of_the_canvas():
    canvas = Canvas(2, 1, (0.0, 1.0), (0.0, 1.0))
    canvas.points(np.array([0.0, 1.0]), np.array([0.0, 1.0]), 0)
    assert canvas.text() == ["⡀⠈"]


def test_a_horizontal_line_fills_one_row_of_dots():
    canvas = Canvas(4, 2, (0.0, 7.0), (0.0, 7.0))
    canvas.line(np.array([0.0, 7.0]), np.array([7.0, 7.0]), 0)
    assert canvas.text() == ["⠉⠉⠉⠉", "    "]


def test_a_diagonal_line_has_no_holes():
    canvas = Canvas(8, 4, (0.0, 15.0), (0.0, 15.0))
    canvas.line(np.array([0.0, 15.0]), np.array([0.0, 15.0]), 0)
    assert dots(canvas) == 16


def test_a_bar_stands_upright_and_a_dash_lies_through_its_middle():
    canvas = Canvas(4, 2, (0.0, 7.0), (0.0, 7.0))
    x, y = np.array([4.0]), np.array([3.0])
    canvas.bars(x, y - 3.0, y + 3.0, 0)
    canvas.dashes(x, y, 0)
    assert canvas.text() == ["  ⡆ ", " ⠈⡏ "]


def test_a_solid_level_has_twice_the_dots_of_a_dashed_one():
    dashed, solid = (Canvas(6, 2, (0.0, 1.0), (0.0, 1.0)) for _ in range(2))
    dashed.level(0.5, 0)
    solid.level(0.5, 0, dashed=False)
    assert (dots(dashed), dots(solid)) == (6, 12)


def test_a_cursor_is_a_dotted_upright_line():
    canvas = Canvas(2, 2, (0.0, 3.0), (0.0, 1.0))
    canvas.upright(2.0, 0)
    assert canvas.text() == [" ⠅", " ⠅"]


def test_nan_breaks_a_line():
    whole, broken = (Canvas(8, 1, (0.0, 4.0), (0.0, 1.0)) for _ in range(2))
    x = np.arange(5.0)
    whole.line(x, np.zeros(5), 0)
    broken.line(x, np.array([0.0, 0.0, np.nan, 0.0, 0.0]), 0)
    assert broken.text() == ["⣀⣀⡀  ⢀⣀⣀"]
    assert whole.text() == ["⣀" * 8]


def test_a_lonely_sample_of_a_line_is_seen():
    canvas = Canvas(3, 1, (0.0, 2.0), (0.0, 1.0))
    canvas.line(np.arange(3.0), np.array([np.nan, 1.0, np.nan]), 0)
    assert dots(canvas) == 1


def test_the_last_mark_gives_a_cell_its_colour_and_keeps_the_dots_of_the_others():
    canvas = Canvas(1, 1, (0.0, 1.0), (0.0, 3.0))
    canvas.points(np.array([0.0]), np.array([3.0]), 0)
    canvas.points(np.array([1.0]), np.array([0.0]), 1)
    assert canvas.ink[0, 0] == 1
    assert dots(canvas) == 2


def test_values_far_outside_do_not_cost_memory():
    canvas = Canvas(10, 5, (0.0, 1.0), (0.0, 1.0))
    canvas.line(np.array([0.0, 0.5, 1.0]), np.array([0.5, 1e300, 0.5]), 0)
    assert dots(canvas) > 0


numbers = st.floats(allow_nan=True, allow_infinity=True, width=32)


@given(st.lists(st.tuples(numbers, numbers), max_size=20))
def test_any_numbers_can_be_drawn(points: list[tuple[float, float]]):
    x, y = (np.array([p[k] for p in points]) for k in (0, 1))
    canvas = Canvas(10, 5, (-1.0, 1.0), (-1.0, 1.0))
    canvas.line(x, y, 0)
    canvas.points(x, y, 1)
    assert [len(row) for row in canvas.text()] == [10] * 5


@pytest.mark.parametrize("count", [1, 7, 300])
def test_every_finite_point_inside_is_seen(count: int):
    random = np.random.default_rng(count)
    canvas = Canvas(100, 50, (0.0, 1.0), (0.0, 1.0))
    x, y = random.random(count), random.random(count)
    canvas.points(x, y, 0)
    cells = {
        (int(np.rint((1 - b) * 199)) // 4, int(np.rint(a * 199)) // 2) for a, b in zip(x, y, strict=True)
    }
    assert {tuple(cell) for cell in np.argwhere(canvas.ink == 0)} == cells
