"""A number that is not the same from the first manoeuvre to the last is no effect of the catalogue."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HARD = Setup(maneuvers=8, gust_std=0.1, coloured=0.5, jitter=0.003, speed_change=0.03, seed=61)


def through_a_vane(setup, lags_s):
    """Return a flight whose vane has another lag in each manoeuvre."""
    return [fly(replace(setup, switches={"vane_lag": lag}))[i] for i, lag in enumerate(lags_s)]


@pytest.mark.parametrize(
    "setup", [Setup(maneuvers=8, seed=62), pytest.param(replace(HARD, seed=63), marks=pytest.mark.study)]
)
@pytest.mark.study
def test_a_lag_that_is_a_third_longer_in_the_end_keeps_its_name(setup):
    found = diagnose(through_a_vane(setup, np.linspace(0.04, 0.053, 8)), Aircraft())
    assert found.verdict == "effect"
    assert found.causes[0].effect == "alpha_lag"
