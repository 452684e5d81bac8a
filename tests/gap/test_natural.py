"""Telemetry is no gap of the simulator: each model flies with the flight's natural numbers."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import AIRSPEED, GYRO
from advisor.gap.fitting.natural import with_natural
from advisor.gap.fitting.problem import SearchPoint
from advisor.gap.fitting.refit import own_refitted
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.simulator.layout import DERIVATIVES
from tests.gap.generator import Setup, fly
from tests.maneuvers import changed


@pytest.fixture(scope="module")
def late():
    """Return a flight whose command is stamped 12 ms too early, its plain fit, and the right derivatives."""
    maneuvers = fly(Setup(maneuvers=3, seed=8))
    _, fitted = fit_baseline(prepare(maneuvers, Aircraft()), Aircraft())
    right = fitted.point.derivatives
    shifted = [changed(m, "elevator", t=m.channels["elevator"].t - 0.012) for m in maneuvers]
    file = Aircraft(model=dict(zip(DERIVATIVES, map(float, right), strict=True)))
    return (*fit_baseline(prepare(shifted, file), file), right)


def test_the_lateness_of_the_command_is_no_error_of_a_right_model(late):
    problem, fitted, right = late
    model = SearchPoint(right, fitted.point.own)
    flown = with_natural(problem, model, fitted.point, fitted.noise)
    points = (flown, model, replace(fitted.point, edges=None))
    q = problem.channels.index("q")
    natural, plain, best = (own_refitted(problem, one, fitted.noise).mean_square[q] for one in points)
    assert natural - best < 0.1 * (plain - best)


def test_the_given_derivatives_stay_whatever_the_flight_says(late):
    problem, fitted, right = late
    wrong = right * np.array([1.0, 1.0, 1.0, 1.4, 1.0, 0.7])
    flown = with_natural(problem, SearchPoint(wrong, fitted.point.own), fitted.point, fitted.noise)
    assert np.array_equal(flown.derivatives, wrong)
    assert flown.effects == fitted.point.effects


def test_the_natural_numbers_come_from_other_manoeuvres_than_those_judged(late):
    problem, fitted, right = late
    model = SearchPoint(right, fitted.point.own)
    whole, without = (
        with_natural(problem, model, fitted.point, fitted.noise, aside).shared for aside in ((), (0, 2))
    )
    assert not np.array_equal(whole, without)


def test_every_model_has_the_bias_of_its_gyro_as_wide_as_data_sheets_state_it():
    biased = []
    for one in fly(Setup(maneuvers=3, seed=9)):
        q = one.channels["q"]
        biased.append(changed(one, "q", y=q.y + np.radians(0.13)))
    _, fitted = fit_baseline(prepare(biased, Aircraft()), Aircraft())
    bias = fitted.point.values[fitted.point.effects.index(GYRO)]
    assert np.degrees(bias) == pytest.approx([0.13], abs=0.02)
    assert np.degrees(GYRO.prior_std) == pytest.approx([0.17], abs=0.01)


def test_every_model_has_a_read_air_speed_as_wrong_as_data_sheets_state_it():
    _, fitted = fit_baseline(prepare(fly(Setup(maneuvers=3, seed=9)), Aircraft()), Aircraft())
    assert AIRSPEED in fitted.point.effects
    assert AIRSPEED.prior_std == (0.05,)
