"""What creeps between manoeuvres shows in the course of the manoeuvres' own trims."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.uncatalogued.trim_course import course_of, trim_courses
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def settled():
    return fit_baseline(prepare(fly(Setup(maneuvers=5, seed=71)), Aircraft()), Aircraft())


def test_a_line_through_values_has_their_slope_and_the_error_of_their_scatter():
    t = 30.0 * np.arange(6)
    scatter = 1e-4 * np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0])
    course = course_of("attitude", t, 0.02 - 3e-5 * t + scatter)
    assert course.slope_per_s == pytest.approx(-3e-5, rel=0.05)
    assert course.sigmas > 10.0
    assert course_of("attitude", t, scatter).sigmas < 1.0


def test_unknown_values_and_too_few_manoeuvres_have_no_course():
    t = 30.0 * np.arange(5)
    assert course_of("attitude", t, np.array([0.0, np.nan, 0.1, np.nan, 0.2])) is None
    assert course_of("attitude", t[:3], np.zeros(3)) is None
    assert course_of("attitude", t, np.array([0.0, np.nan, 0.1, 0.15, 0.2])).maneuvers == 4


def test_a_trim_that_creeps_shows_in_its_own_course_alone(settled):
    problem, fitted = settled
    at_s = np.array([flight.started_s for flight in problem.flights.flights])
    rate = 5e-5 * fitted.point.derivatives[5]
    own = fitted.point.own.copy()
    own[:, 3] += rate * (at_s - at_s[0])
    crept = replace(fitted, point=replace(fitted.point, own=own))
    before, after = ({c.quantity: c for c in trim_courses(problem, f)} for f in (fitted, crept))
    change = after["elevator_trim"].slope_per_s - before["elevator_trim"].slope_per_s
    assert change == pytest.approx(-5e-5)
    assert after["elevator_trim"].sigmas > 5.0
    assert after["zero_lift_alpha"] == before["zero_lift_alpha"]


def test_a_flight_without_drift_has_no_significant_course(settled):
    assert all(course.sigmas < 5.0 for course in trim_courses(*settled))
