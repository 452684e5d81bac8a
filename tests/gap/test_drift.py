"""A number that is not the same from the first manoeuvre to the last is no effect of the catalogue."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from tests.gap.generator import Setup, fly

pytestmark = pytest.mark.study
"""Whole diagnoses, run by ``make study-gap``."""

HARD = Setup(maneuvers=8, gust_std=0.1, coloured=0.5, jitter=0.003, speed_change=0.03, seed=61)


def late_by(flown, channel, delays_s):
    """The same flight with one channel late, in each manoeuvre by so much."""
    return [
        replace(
            m, channels={**m.channels, channel: replace(m.channels[channel], t=m.channels[channel].t + late)}
        )
        for m, late in zip(flown, delays_s, strict=True)
    ]


def through_a_vane(setup, lags_s):
    """A flight whose vane has another lag in each manoeuvre."""
    return [fly(replace(setup, switches={"vane_lag": lag}))[i] for i, lag in enumerate(lags_s)]


@pytest.mark.parametrize("setup", [Setup(maneuvers=8, seed=60), pytest.param(HARD, marks=pytest.mark.study)])
@pytest.mark.parametrize(
    ("channel", "block"), [("alpha", "timing"), pytest.param("a_z", "timing", marks=pytest.mark.study)]
)
def test_a_clock_that_runs_off_is_unknown_in_the_time_stamps(setup, channel, block):
    found = diagnose(late_by(fly(setup), channel, np.linspace(0.0, 0.06, 8)), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == block


@pytest.mark.parametrize("setup", [Setup(maneuvers=8, seed=60), pytest.param(HARD, marks=pytest.mark.study)])
def test_a_vane_that_grows_slower_is_unknown_in_the_vane(setup):
    found = diagnose(through_a_vane(setup, np.linspace(0.001, 0.08, 8)), Aircraft())
    assert found.verdict == "unknown"
    assert found.where.block == "alpha_sensor"
    assert any("not the same throughout" in note for note in found.notes)


@pytest.mark.parametrize(
    "setup", [Setup(maneuvers=8, seed=62), pytest.param(replace(HARD, seed=63), marks=pytest.mark.study)]
)
@pytest.mark.study
def test_a_lag_that_is_a_third_longer_in_the_end_keeps_its_name(setup):
    found = diagnose(through_a_vane(setup, np.linspace(0.04, 0.053, 8)), Aircraft())
    assert found.verdict == "effect"
    assert found.causes[0].effect == "alpha_lag"


def test_a_lag_that_comes_and_goes_is_one_of_the_way_and_not_of_the_vane():
    lags = [0.09, 0.02, 0.1, 0.03, 0.08, 0.01, 0.09, 0.02]
    found = diagnose(through_a_vane(Setup(maneuvers=8, seed=60), lags), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "timing")
    assert any("another in every manoeuvre" in note for note in found.notes)


@pytest.mark.parametrize("setup", [Setup(maneuvers=8, seed=60), pytest.param(HARD, marks=pytest.mark.study)])
def test_a_clock_that_is_set_again_and_again_is_unknown_in_the_time_stamps(setup):
    late = [0.08, 0.05, 0.11, 0.06, 0.1, 0.04, 0.09, 0.07]
    found = diagnose(late_by(fly(setup), "alpha", late), Aircraft())
    assert (found.verdict, found.where.block) == ("unknown", "timing")
    assert any("another in every manoeuvre" in note for note in found.notes)
