"""Terms that the user adds to roll and yaw, and derivatives that the user holds."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.motion import with_hidden
from advisor.oem.axis.parameter import parameters_of
from advisor.oem.axis.problem import TERM, AxisProblem
from advisor.oem.axis.search import Searched, search, solve
from advisor.oem.estimate import NoEstimate
from advisor.oem.identifiability import log_likelihood
from advisor.oem.solution import Solution
from tests.oem.axis.builders import JET, aileron_doublet, flown, rudder_doublet

CUBE = 600.0
"""Coefficient of β³ in the rolling moment, 1/s²: at 4 deg of sideslip a fifth of L_β·β."""


def problem_of(measured: tuple[str, ...], cubes: dict[str, float]) -> AxisProblem:
    t = np.arange(0.0, 10.0, 0.05)
    inputs = {"aileron": aileron_doublet(t)}, {"rudder": rudder_doublet(t)}
    rng = np.random.default_rng(3)
    records = tuple(
        flown(JET, measured=measured, rng=rng, cubes=cubes, seconds=10.0, rate_hz=20.0, **one)
        for one in inputs
    )
    return AxisProblem(LATERAL, records)


def with_terms(problem: AxisProblem, *terms: str) -> AxisProblem:
    return replace(problem, values={(TERM, term): 0.0 for term in terms})


def solved(problem: AxisProblem) -> Solution:
    found = solve(problem, parameters_of(problem, Aircraft()))
    assert not isinstance(found, NoEstimate)
    return found


@pytest.fixture(scope="module")
def cubed() -> AxisProblem:
    return problem_of(("p", "r", "bank", "a_y", "beta"), {"L": CUBE, "Y": -20.0})


def test_the_coefficient_of_each_term_is_that_of_the_aircraft(cubed):
    # The noise of the vane is in the factor, which makes a coefficient some per cent too small.
    told = solved(with_terms(cubed, "L:beta**3", "Y:beta**3")).nuisances
    for term, truth in (("L:beta**3", CUBE), ("Y:beta**3", -20.0)):
        value, std = told[term]
        assert value == pytest.approx(truth, rel=0.1)
        assert std < 0.2 * abs(truth)


def test_a_term_that_acts_gains_likelihood(cubed):
    fits = [
        search(problem, parameters_of(problem, Aircraft()))
        for problem in (with_terms(cubed, "L:beta**3"), cubed)
    ]
    with_it, without_it = (log_likelihood(fit.still) for fit in fits if isinstance(fit, Searched))
    assert with_it > without_it + 10.0


def test_a_sideslip_that_no_vane_measures_is_the_models():
    blind = problem_of(("p", "r", "bank", "a_y"), {"L": CUBE})
    plain, blind = blind, with_terms(blind, "L:beta**3")
    assert blind.needs_hidden
    seen = with_hidden(blind, solved(plain))
    assert not seen.needs_hidden
    value, _ = solved(seen).nuisances["L:beta**3"]
    assert value == pytest.approx(CUBE, rel=0.4)


def test_a_held_derivative_keeps_its_value_and_has_no_error(cubed):
    k = list(JET).index("L_p")
    found = solved(replace(cubed, fixed={"L_p": -2.0}))
    assert found.theta[k] == -2.0
    assert found.widened[k, k] == 0.0
