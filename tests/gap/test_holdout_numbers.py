"""On manoeuvres kept out everything is measured alike, and what one of them alone tells in that one."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.fitting.fit import rms_of
from advisor.gap.fitting.holdout import hold_out, measured_in
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.verdict.holdout_numbers import over_maneuvers
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def filtered():
    """Return a flight whose noise has a memory: innovations are not the errors."""
    problem, fitted = fit_baseline(
        prepare(fly(Setup(maneuvers=6, coloured=0.9, rate_hz=25.0, seed=33)), Aircraft()), Aircraft()
    )
    assert problem.knows_the_noise
    return problem, fitted, hold_out(problem, fitted)


def test_what_a_manoeuvre_alone_tells_is_measured_in_it_errors_and_innovations_alike(filtered):
    problem, fitted, held = filtered
    everywhere = measured_in(problem, held, fitted, range(len(problem.flights)))
    assert everywhere.mean_square == pytest.approx(rms_of(problem, fitted.residuals) ** 2)
    assert everywhere.innovation_square == pytest.approx(rms_of(problem, fitted.innovations) ** 2)
    nowhere = measured_in(problem, held, fitted, ())
    assert nowhere.innovation_square == pytest.approx(held.innovation_square)


def test_over_some_manoeuvres_innovations_count_as_their_errors_do(filtered):
    problem, _, held = filtered
    kept = [4, 5]
    some = over_maneuvers(problem, held, kept)
    cut = replace(problem, flights=replace(problem.flights, flights=problem.flights.flights[4:]))
    assert some.mean_square == pytest.approx(rms_of(cut, held.residuals[4:]) ** 2)
    assert some.innovation_square == pytest.approx(rms_of(cut, held.innovations[4:]) ** 2)
    assert not np.allclose(some.innovation_square, some.mean_square)
