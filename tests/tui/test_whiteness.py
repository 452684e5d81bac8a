"""Autocorrelation of residuals against answers that are known in closed form."""

import numpy as np
import pytest

from advisor.tui.panes.residuals import autocorrelation, white_noise_bound


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
