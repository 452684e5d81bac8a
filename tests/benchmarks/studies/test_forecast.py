"""Forecasts are scored against the stop that came."""

import pytest

from benchmarks.studies.forecast import Forecast, Score, score


@pytest.mark.parametrize(
    ("stop", "flown", "expected"),
    [
        (4, 7, (1, 1)),
        (5, 7, (1, 0)),
        (None, 3, (0, 0)),
        (None, 4, (1, 0)),
    ],
)
def test_a_forecast_is_kept_where_the_stop_comes_within_its_90_percent(stop, flown, expected):
    found = score([([Forecast(2, 1, 2)], stop, flown)])
    assert (found.checked, found.kept) == expected


def test_a_stop_denies_that_no_end_was_in_sight():
    assert score([([Forecast(2, None, None)], 3, 3)]) == Score(1, 0, 0, 0)
    assert score([([Forecast(2, None, None)], None, 3)]) == Score(0, 0, 0, 0)


def test_a_stop_keeps_a_forecast_without_a_largest_number():
    assert score([([Forecast(2, 1, None)], 5, 5)]) == Score(1, 1, 0, 0)


@pytest.mark.parametrize(("median", "jumped"), [(1, 0), (3, 0), (4, 0), (5, 1)])
def test_a_median_that_moves_by_more_than_its_own_band_has_jumped(median, jumped):
    found = score([([Forecast(1, 3, 5), Forecast(2, median, median + 2)], 6, 6)])
    assert (found.followed, found.jumped) == (1, jumped)
