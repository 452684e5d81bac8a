"""The search for gusts in residuals."""

import numpy as np
import pytest

from advisor.oem import turbulence
from advisor.oem.short_period_motion import short_period_motion
from advisor.oem.turbulence import Rows, find_turbulence

MOTION = short_period_motion(np.array([-4.0, 0.0, -40.0, -4.0]), 25.0)


@pytest.mark.parametrize("size", [0.0, 1e-14, 1e9])
def test_the_search_for_moving_air_ends_without_noise_and_with_absurd_noise(size):
    t = np.arange(0.0, 6.0, 0.02)
    rows = Rows(
        np.repeat(t, 4), np.tile(np.arange(4), len(t)), size * np.sin(np.arange(4.0 * len(t))), MOTION
    )
    found = find_turbulence([rows], np.full(4, 1e-3))
    assert found.gust_angle < 0.0017 or size > 1.0


@pytest.mark.parametrize(("gain", "looks"), [(4.9, False), (5.1, True)])
def test_moving_air_is_sought_where_colour_gains_five_nats_over_white_noise(monkeypatch, gain, looks):
    searches = []

    def likeliest(terms, noise, free, settled):
        searches.append(free)
        return noise

    costs = iter([100.0, 100.0 + 2.0 * gain])
    monkeypatch.setattr(turbulence, "likeliest", likeliest)
    monkeypatch.setattr(turbulence, "cost_of", lambda *_: next(costs, 100.0))
    rows = Rows(np.arange(8.0), np.tile(np.arange(4), 2), np.ones(8), MOTION)
    find_turbulence([rows], np.full(4, 1e-3))
    assert (len(searches) > 1) is looks
