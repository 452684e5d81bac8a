"""What part of a time axis is looked at, and where the cursor stands."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from advisor.tui.plot.axis import Sight, Window, nearest

STAMPS = np.arange(-2.0, 8.01, 0.02)
WHOLE = Window.whole(-2.0, 8.0)


def test_zooming_keeps_the_place_of_the_time_it_is_about():
    window = WHOLE.zoom(2.0, 0.0)
    assert window.shown == pytest.approx((-1.0, 4.0))


def test_zooming_out_ends_at_the_whole_record():
    window = WHOLE.zoom(4.0, 7.0).zoom(0.01, 7.0)
    assert window.shown == (-2.0, 8.0)
    assert not window.zoomed


def test_zooming_in_ends_at_a_hundredth_of_the_record():
    low, high = WHOLE.zoom(1e6, 3.0).shown
    assert high - low == pytest.approx(0.1)


def test_panning_stops_at_the_ends_of_the_record():
    window = WHOLE.zoom(2.0, 0.0)
    assert window.pan(0.2).shown == pytest.approx((0.0, 5.0))
    assert window.pan(9.0).shown == pytest.approx((3.0, 8.0))
    assert window.pan(-9.0).shown == pytest.approx((-2.0, 3.0))


def test_a_window_moves_only_as_far_as_a_value_needs():
    window = WHOLE.zoom(5.0, 0.0)
    low, high = window.shown
    assert window.showing(0.5 * (low + high)).shown == pytest.approx(window.shown)
    assert window.showing(5.0).shown == pytest.approx((3.0, 5.0))
    assert window.showing(-2.0).shown == pytest.approx((-2.0, 0.0))


def test_another_record_is_shown_whole_unless_the_last_one_was_zoomed():
    assert WHOLE.over(-1.0, 20.0).shown == (-1.0, 20.0)
    assert WHOLE.zoom(2.0, 0.0).over(-1.0, 20.0).shown == pytest.approx((-1.0, 4.0))


@given(
    steps=st.lists(st.sampled_from(["in", "out", "left", "right", "cursor", "back", "other"]), max_size=12),
    about=st.floats(-3.0, 9.0),
)
def test_whatever_is_pressed_the_window_stays_inside_the_record(steps: list[str], about: float):
    sight = Sight(WHOLE)
    for step in steps:
        sight = {
            "in": lambda s: s.zoomed(1, about),
            "out": lambda s: s.zoomed(-1),
            "left": lambda s: s.panned(-1),
            "right": lambda s: s.panned(1),
            "cursor": lambda s: s.stepped(1, STAMPS, finely=False),
            "back": lambda s: s.stepped(-1, STAMPS, finely=True),
            "other": lambda s: s.over(-1.0, 5.0, STAMPS),
        }[step](sight)
        window = sight.window
        assert window.first - 1e-9 <= window.low < window.high <= window.last + 1e-9


def test_the_nearest_sample_is_read():
    x = np.array([0.0, 1.0, 3.0])
    assert [nearest(x, value) for value in (-9.0, 0.4, 0.6, 2.1, 9.0)] == [0, 0, 1, 2, 2]


def test_the_cursor_begins_at_the_start_of_the_input():
    assert Sight(WHOLE).stepped(1, STAMPS, finely=False).cursor == pytest.approx(0.0)


def test_the_cursor_crosses_the_record_in_a_hundred_steps_or_sample_by_sample():
    sight = Sight(WHOLE, 0.0)
    assert sight.stepped(1, STAMPS, finely=False).cursor == pytest.approx(0.1)
    assert sight.stepped(-1, STAMPS, finely=True).cursor == pytest.approx(-0.02)


def test_the_window_follows_the_cursor():
    sight = Sight(WHOLE.zoom(100.0, 0.0), 0.0)
    for _ in range(20):
        sight = sight.stepped(1, STAMPS, finely=True)
    assert sight.cursor == pytest.approx(0.4)
    assert sight.window.low <= sight.cursor <= sight.window.high


def test_a_record_without_samples_has_no_cursor():
    assert Sight(WHOLE).stepped(1, np.zeros(0), finely=False).cursor is None
