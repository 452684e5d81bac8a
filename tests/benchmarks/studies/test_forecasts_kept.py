"""Forecasts of whole campaigns: nine in ten are kept, and no forecast leaves its own band."""

from collections.abc import Sequence

import pytest

from benchmarks.lateral_campaigns import campaigns
from benchmarks.studies.covered import draws, fly
from benchmarks.studies.forecast import Forecast, score
from sim.sealed.score import wilson

GOAL = (0.85, 0.95)
"""Share of forecasts in which the stop comes within the stated number."""


def _check(flown: Sequence[tuple[Sequence[Forecast], int | None, int]]) -> None:
    told = score(flown)
    low, high = wilson(told.kept, told.checked)
    assert told.checked >= len(flown) // 2
    assert high >= GOAL[0], f"{told.kept} of {told.checked} forecasts are kept"
    assert low <= GOAL[1], f"{told.kept} of {told.checked} forecasts are kept"
    assert told.jumped == 0, f"{told.jumped} of {told.followed} forecasts jump beyond their band"


@pytest.mark.study
@pytest.mark.timeout(1800)
def test_forecasts_of_roll_and_yaw_are_kept_and_stay_in_their_band() -> None:
    flown = list(campaigns(30112702, count=12, flights=3))
    _check([(one.forecasts, one.stopped_at, one.flown) for one in flown])


@pytest.mark.study
@pytest.mark.timeout(1800)
def test_forecasts_of_pitch_are_kept_and_stay_in_their_band() -> None:
    flown = [fly(drawn) for drawn in draws(24, 30112701)]
    _check([(one.forecasts, one.stop.after if one.stop else None, one.flown) for one in flown])
