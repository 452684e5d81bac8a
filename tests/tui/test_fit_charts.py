"""What the fit pane draws of one manoeuvre, and of two laid over one another."""

import csv
from io import StringIO

import numpy as np
import pytest

from advisor.tui.panes.fit import (
    ELEVATOR_AXIS,
    extent,
    fit_chart,
    input_chart,
    residual_chart,
    rows_of_fit,
    since_start,
)
from advisor.tui.panes.residuals import Whiteness, autocorrelation, white_noise_bound
from tests.tui import flights

FIRST, FOURTH = flights.judged(1), flights.judged(4)


def test_manoeuvres_flown_at_different_times_are_aligned_at_the_start_of_their_inputs():
    for judged in (FIRST, FOURTH):
        elevator = judged.maneuver.channels["elevator"]
        t = since_start(judged, elevator.t)
        assert t[np.flatnonzero(elevator.y)[0]] == pytest.approx(0.0, abs=1e-9)


def test_equal_inputs_lie_over_one_another():
    first, second = input_chart("elevator", FIRST, FOURTH).series
    assert first.x == pytest.approx(second.x)
    assert first.y == pytest.approx(second.y)
    assert (first.name, second.name) == ("elevator 4", "elevator 1")


def test_of_two_manoeuvres_what_was_measured_and_the_residuals_are_drawn():
    assert [s.name for s in fit_chart("q", FIRST, FOURTH).series] == ["measured 4", "measured 1"]
    assert [s.name for s in residual_chart("q", FIRST, FOURTH).series] == ["residual 4", "residual 1"]


def test_a_manoeuvre_without_an_estimate_is_laid_over_as_it_was_recorded():
    series = fit_chart("q", FIRST, flights.without_estimate(3)).series
    assert [s.name for s in series] == ["measured 3", "measured 1"]
    assert len(residual_chart("q", FIRST, flights.without_estimate(3)).series) == 1


def test_the_longer_of_two_records_sets_the_time_axis():
    assert extent(FIRST, None) == pytest.approx((-2.0, 8.0))
    assert extent(FIRST, FOURTH) == pytest.approx((-2.0, 8.0))


def test_the_rows_hold_every_sample_in_the_unit_that_they_name():
    rows = list(csv.DictReader(StringIO(rows_of_fit(FIRST, None, ELEVATOR_AXIS).csv())))
    of_q = [row for row in rows if row["channel"] == "q"]
    fit = FIRST.estimate.fits[0]["q"]
    assert {row["unit"] for row in of_q} == {"deg/s"}
    assert [float(row["measured"]) for row in of_q] == pytest.approx(np.degrees(fit.measured), abs=1e-5)
    assert [float(row["residual"]) for row in of_q] == pytest.approx(np.degrees(fit.residual), abs=1e-5)
    assert {row["fitted"] for row in rows if row["channel"] == "elevator"} == {""}


def test_white_residuals_stay_inside_their_bounds_at_most_lags():
    white = Whiteness.of(FIRST.estimate.fits[0]["q"])
    assert white.lag_s[0] == pytest.approx(0.02)
    assert white.outside < 0.15 * len(white.r)


def test_a_residual_that_alternates_has_the_autocorrelation_of_its_overlap():
    n = 40
    r = autocorrelation(np.tile([1.0, -1.0], n // 2), 5)
    assert r == pytest.approx([(-1.0) ** k * (n - k) / n for k in range(6)])


def test_the_mean_of_a_residual_does_not_count():
    v = np.array([1.0, -1.0, 1.0, -1.0])
    assert autocorrelation(v + 7.0, 3) == pytest.approx(autocorrelation(v, 3))


def test_a_residual_without_spread_has_no_autocorrelation():
    assert autocorrelation(np.full(9, 2.0), 4).tolist() == [0.0] * 5


def test_samples_that_are_not_finite_are_left_out():
    v = np.array([1.0, -1.0, np.nan, 1.0, -1.0])
    assert autocorrelation(v, 2) == pytest.approx([1.0, -0.75, 0.5])
    assert autocorrelation(np.array([np.nan]), 3).tolist() == [0.0]


def test_no_lag_is_longer_than_the_record():
    assert len(autocorrelation(np.array([1.0, 2.0, 4.0]), 50)) == 3


def test_white_noise_leaves_its_bounds_at_one_lag_in_twenty():
    noise = np.random.default_rng(5).normal(size=20_000)
    outside = np.abs(autocorrelation(noise, 2000)[1:]) > white_noise_bound(len(noise))
    assert 0.03 < outside.mean() < 0.07


def test_the_bound_falls_with_the_root_of_the_samples():
    assert white_noise_bound(400) == pytest.approx(0.098, rel=1e-3)
