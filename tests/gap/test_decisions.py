"""Every decision is a number against a limit, and a name needs the support of manoeuvres kept out."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.candidates.catalogue import variants_for
from advisor.gap.effects import EFFECTS
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.holdout import held_out, hold_out
from advisor.gap.fitting.step import bounds_of
from advisor.gap.fitting.uncertainty import effective_samples
from advisor.gap.fitting.whitening import Filters
from advisor.gap.records.prepare import prepare
from advisor.gap.search.baseline import fit_baseline
from advisor.gap.search.score import addition, log_likelihood_gained, support_of
from advisor.gap.simulator.layout import DERIVATIVES
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def late():
    """Return the data of a flight with late accelerometers, and the delay as an addition to the baseline."""
    flights = prepare(fly(Setup(maneuvers=3, skew={"a_z": 0.02}, seed=61)), Aircraft())
    problem, plain = fit_baseline(flights, Aircraft())
    variant = next(v for v in variants_for(flights) if v.effect == "accelerometer_skew")
    fitted = fit(problem, plain.point.with_effect(variant, variant.starts[0]), plain.noise, 25)
    effective = effective_samples(problem, fitted.innovations)
    return problem, addition(problem, plain, hold_out(problem, plain), fitted, variant.effect, effective)


def leaving(problem, *sizes):
    """Return the residual of a model that misses each manoeuvre's channels by multiples of the noise."""
    residuals = []
    for flight, size in zip(problem.flights.flights, sizes, strict=True):
        residual = np.empty(len(flight.stamps))
        for rows, noise in zip(problem.rows(flight), problem.instruments, strict=True):
            residual[rows] = size * noise
        residuals.append(residual)
    return held_out(problem, residuals)


def test_an_effect_that_helps_every_manoeuvre_is_supported(late):
    problem, _ = late
    assert support_of(problem, leaving(problem, 3.0, 3.1, 3.2), leaving(problem, 1.0, 1.0, 1.0)) > 10.0


def test_an_effect_that_helps_one_manoeuvre_and_harms_another_is_not(late):
    problem, _ = late
    assert abs(support_of(problem, leaving(problem, 3.0, 2.0, 2.0), leaving(problem, 1.0, 2.6, 2.0))) < 1.0


def test_an_effect_that_harms_manoeuvres_kept_out_has_less_than_no_support(late):
    problem, _ = late
    assert support_of(problem, leaving(problem, 1.0, 1.0, 1.0), leaving(problem, 2.0, 2.1, 2.2)) < -1.0


def test_a_gust_in_a_manoeuvre_kept_out_takes_no_support_from_an_effect(late):
    problem, _ = late
    filtered = replace(problem, whitening=Filters((), (), ()))
    louder = leaving(problem, 3.0, 3.0, 9.0).residuals
    quieter = [3.0 * np.ones(len(r)) for r in louder], [np.ones(len(r)) for r in louder]
    before = held_out(problem, leaving(problem, 3.0, 3.0, 3.0).residuals, quieter[0])
    after = held_out(problem, louder, quieter[1])
    assert support_of(filtered, before, after) > 10.0


@pytest.mark.parametrize(("support", "named"), [(0.9, False), (1.1, True)])
def test_a_name_needs_more_than_the_standard_error_of_the_gap_that_it_removes(late, support, named):
    _, judged = late
    assert replace(judged, support=support).is_accepted == named


@pytest.mark.parametrize("otherwise", [{"sole_maneuver": 1}, {"prior_gain": 20.0}])
def test_what_no_other_manoeuvre_can_foretell_needs_no_support_of_theirs(late, otherwise):
    _, judged = late
    unsupported = replace(judged, gain=500.0, support=0.0)
    assert not unsupported.is_accepted
    assert replace(unsupported, **otherwise).is_accepted


def test_a_loss_within_the_standard_error_of_the_hold_out_is_none(late):
    problem, judged = late
    better, worse = leaving(problem, 1.0, 1.0, 1.0), leaving(problem, 1.1, 1.1, 1.1)
    fitted, samples = judged.fitted, np.full(len(problem.channels), 50.0)
    wide = replace(fitted, noise=1.2 * fitted.noise)
    assert log_likelihood_gained(wide, better, fitted, worse, samples, support=-0.5) == 0.0
    assert log_likelihood_gained(wide, better, fitted, worse, samples, support=-2.0) < 0.0


def test_each_decision_about_a_name_holds_where_it_is_named(late):
    _, judged = late
    questions = [decision.name for decision in judged.decisions]
    assert questions == ["likelihood", "change", "significance", "size", "range", "hold-out"]
    assert all(decision.holds for decision in judged.decisions) == judged.is_accepted


@pytest.mark.parametrize(
    ("otherwise", "only_small"),
    [({"smallest": 1.0}, True), ({"smallest": 1.0, "support": 0.0}, False), ({}, False)],
)
def test_an_effect_is_only_small_where_nothing_but_its_size_rejects_it(late, otherwise, only_small):
    _, judged = late
    assert replace(judged, **otherwise).is_only_small is only_small


def test_no_derivative_makes_an_aircraft_that_nobody_can_fly(late):
    problem, judged = late
    astray = replace(judged.fitted.point, derivatives=judged.fitted.point.derivatives.copy())
    astray.derivatives[DERIVATIVES.index("M_alpha")] = 312.0
    found = fit(problem, astray, judged.fitted.noise, 25)
    assert np.all(found.point.derivatives <= bounds_of(found.point)[1][: len(DERIVATIVES)])


def test_a_value_at_the_end_of_its_range_names_the_parameter_and_the_range(late):
    _, judged = late
    mode = EFFECTS["structural_mode"].variants(late[0].flights)[0]
    value = np.array([1.0, 1.0, 80.0, 0.05])
    at_the_end = replace(judged, variant=mode, value=value)
    (question,) = [one for one in at_the_end.decisions if one.name == "range"]
    assert not question.holds
    assert (question.parameter, question.searched) == ("omega_rad_s", (12.0, 80.0))
