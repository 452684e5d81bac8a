"""The prediction of held-out manoeuvres by a fit of the others."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.known import variants_for
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.holdout import folds_for, folds_of, hold_out
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def heavier():
    """Return nine manoeuvres, the last five with a heavier aircraft, and the baseline fit."""
    flights = prepare(fly(Setup(maneuvers=9, mass_step=0.25, noise=0.005, rate_hz=25.0, seed=3)), Aircraft())
    return fit_baseline(flights, Aircraft())


@pytest.mark.parametrize("break_", [3, 5])
def test_the_time_of_a_change_stays_where_only_manoeuvres_kept_out_tell_it(heavier, break_):
    problem, plain = heavier
    steps = [v for v in variants_for(problem.flights) if v.effect == "mass_change" and "step" in v.names]
    gradual = next(form for form in steps[break_].likewise if "over_s" in form.names)
    at_s, over_s = steps[break_].fixed["at_s"], 20.0
    point = plain.point.with_effect(gradual, (0.2, at_s - 0.5 * over_s, over_s))
    fitted = fit(problem, point, plain.noise, tolerance=0.5)
    predicted = hold_out(problem, fitted)
    assert np.all(predicted.innovation_square < 3.0 * fitted.noise**2)


@pytest.mark.parametrize("n", [1, 2, 3, 5, 9, 14])
@pytest.mark.parametrize("shifted", [False, True])
def test_every_manoeuvre_is_kept_out_once(n, shifted):
    folds = folds_of(n, shifted)
    assert sorted(i for fold in folds for i in fold) == list(range(n))
    assert all(folds)


def throttled(*moves_in):
    """Six manoeuvres of an aircraft whose thrust pitches it, the throttle moved in some of them."""
    return fly(
        Setup(
            maneuvers=6, thrust_amplitude=0.6, thrust_moves_in=moves_in, switches={"thrust_arm": 0.3}, seed=71
        )
    )


def test_two_manoeuvres_that_alone_tell_something_are_not_kept_out_together():
    assert not any({0, 3} <= set(fold) for fold in folds_for(prepare(throttled(0, 3), Aircraft())))


@pytest.mark.parametrize("moves_in", [(0, 1, 3), (2,), ()])
def test_folds_are_interleaved_where_others_could_confirm_what_a_fold_tells_or_none_can(moves_in):
    assert folds_for(prepare(throttled(*moves_in), Aircraft())) == folds_of(6)
