"""Side gusts and coloured instruments in residuals made by hand, and the stage that weighs them."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.inference.residual import Residual
from advisor.side_gap import moving_air
from advisor.side_gap.disturbance import courses_of
from advisor.side_gap.fit import fitted
from advisor.side_gap.gusts import coloured_likelihood, side_gusts
from advisor.side_gap.lacking import with_a_lacking_law
from advisor.side_gap.models import case_of
from advisor.side_gap.residual import Beside, residual_of
from tests.oem.lateral_builders import JET
from tests.side_gap.test_comparison import AIRCRAFT, maneuvers

ANGLE = 0.01
NOISE = np.array([0.003, 0.001, 0.002, 0.03, 1.0])


@pytest.fixture(scope="module")
def case():
    model = replace(AIRCRAFT, model=dict(JET))
    return case_of(maneuvers(), model, np.array([JET[name] for name in SIDE_PARAMETERS]))


@pytest.fixture(scope="module")
def flight(case):
    """Return a fit with the true derivatives, and what gusts change in its manoeuvres."""
    fit = fitted(case.flown, case.begin, case.natural, case.known(1e-6, case.natural), rounds=1)
    return fit, courses_of(fit, case.flown), case.known(0.3, fit.free)


def with_residual(fit, residual):
    white = NOISE[fit.assembly.channel] * np.random.default_rng(2).standard_normal(len(residual))
    return replace(fit, fitted=fit.assembly.z - white - residual, noise=NOISE)


def wandering(n, memory, rng):
    x = np.zeros(n)
    for i in range(1, n):
        x[i] = memory * x[i - 1] + np.sqrt(1.0 - memory**2) * rng.standard_normal()
    return x


def test_a_gust_angle_enters_all_outputs_and_its_size_is_found(flight):
    fit, courses, known = flight
    rng = np.random.default_rng(3)
    blown = [ANGLE * course.columns @ wandering(len(course.knots), 0.9, rng) for course in courses]
    gusty = with_residual(fit, np.concatenate(blown))
    found = side_gusts(gusty, courses, known)
    assert found.angle == pytest.approx(ANGLE, rel=0.4)
    assert abs(found.angle - ANGLE) < 4.0 * found.angle_std
    assert found.likelihood > coloured_likelihood(gusty) + 20.0


def test_a_coloured_instrument_is_no_gust(flight):
    fit, courses, known = flight
    rng = np.random.default_rng(4)
    left = np.zeros(len(fit.fitted))
    for named in fit.assembly.rows:
        rows = named["r"]
        left[rows] = 0.004 * wandering(rows.stop - rows.start, 0.95, rng)
    coloured = with_residual(fit, left)
    assert side_gusts(coloured, courses, known).likelihood < coloured_likelihood(coloured) - 20.0


def test_still_air_has_no_gusts(flight):
    fit, courses, known = flight
    still = with_residual(fit, np.zeros(len(fit.fitted)))
    found = side_gusts(still, courses, known)
    assert found.angle < 0.1 * ANGLE
    assert found.likelihood == pytest.approx(coloured_likelihood(still), abs=15.0)


@pytest.mark.parametrize(
    "block",
    ["aileron", "rudder", "rolling_moment", "yawing_moment", "roll_rate_sensor", "yaw_rate_sensor", "air"],
)
def test_a_disturbance_is_found_in_its_block(case, flight, block):
    fit, _, _ = flight
    courses = courses_of(fit, case.flown, block)
    rng = np.random.default_rng(5)
    seen = np.concatenate([c.columns @ wandering(len(c.knots), 0.8, rng) for c in courses])
    largest = np.max(np.abs(seen) / NOISE[fit.assembly.channel])
    found = residual_of(with_residual(fit, 20.0 / largest * seen), case.flown, 1.0)
    assert max(found.whole.blocks, key=lambda one: found.whole.blocks[one]) == block
    assert found.beside_air < found.whole.size if block == "air" else found.whole.size > 0.0


def test_white_noise_leaves_no_residual(case, flight):
    fit, _, _ = flight
    still = with_residual(fit, np.zeros(len(fit.fitted)))
    assert residual_of(still, case.flown, 1.0).whole.size < 0.05


RIGHT = Beside(Residual(0.5, {"rolling_moment": 1.0}), 0.5)
LACKING = Beside(Residual(12.0, {"rolling_moment": 1.0}), 12.0)
BLOWN = Beside(Residual(12.0, {"air": 0.99, "yawing_moment": 0.01}), 0.3)
NONE, EFFECT = 0, 1


@pytest.mark.parametrize(
    ("still", "blown", "residual", "likeliest"),
    [
        ((0.0, 8.0), (-60.0, -60.0), RIGHT, (0, EFFECT)),
        ((0.0, 8.0), (60.0, 20.0), BLOWN, (1, NONE)),
        ((0.0, 8.0), (60.0, 70.0), BLOWN, (1, EFFECT)),
    ],
)
def test_an_effect_wins_where_it_is_the_likelier_in_still_or_in_moving_air(still, blown, residual, likeliest):
    told = with_a_lacking_law(np.array(still), np.array(blown), [residual, residual], 0.1)
    assert np.unravel_index(np.argmax(told.known), told.known.shape) == likeliest
    assert np.max(told.known) > 0.8
    assert np.sum(told.known) + sum(told.unknown.values()) == pytest.approx(1.0)


def test_a_residual_far_above_that_of_any_simulator_is_a_law_without_a_name_in_its_block():
    told = with_a_lacking_law(np.zeros(2), np.full(2, -60.0), [LACKING, LACKING], 0.1)
    assert told.unknown["rolling_moment"] > 0.9


def test_what_side_gusts_explain_is_no_law_without_a_name():
    told = with_a_lacking_law(np.zeros(2), np.full(2, 5.0), [BLOWN, BLOWN], 0.1)
    assert sum(told.unknown.values()) < 0.05


def test_the_derivatives_are_estimated_anew_in_gusts(case, flight):
    """A fit under white noise takes a part of the gusts for derivatives, which a scale then explains."""
    fit, courses, known = flight
    rng = np.random.default_rng(3)
    blown = [ANGLE * course.columns @ wandering(len(course.knots), 0.9, rng) for course in courses]
    gusty = with_residual(fit, np.concatenate(blown))
    found = side_gusts(gusty, courses, known)
    step = np.linalg.solve(found.matrix + np.diag(known.precision), found.gradient)
    white = gusty.columns * gusty.weight[:, None]
    by_white = np.linalg.solve(
        white.T @ white + np.diag(known.precision), white.T @ (gusty.residual * gusty.weight)
    )
    told = np.flatnonzero(np.abs(by_white) > 0.0)
    assert np.linalg.norm((step / np.abs(fit.values + 1e-9))[told]) < np.linalg.norm(
        (by_white / np.abs(fit.values + 1e-9))[told]
    )


@pytest.mark.parametrize(("apart", "stays_behind"), [(0.0, 0.0), (0.0025, 5.0), (0.05, 100.0)])
def test_models_closer_than_a_simulators_own_error_differ_by_few_nats(monkeypatch, apart, stays_behind):
    """The error is half a per cent of the peak: 20 nats at its size, and what the data say beyond."""
    monkeypatch.setattr(moving_air, "change_of", lambda one, other: 0.0 if one is other else apart)
    models = [moving_air.Model(object(), ()), moving_air.Model(object(), ("skew_s",))]
    monkeypatch.setattr(moving_air, "form_error", lambda names, change: 0.0)
    made_up, nothing = moving_air.for_model_error(models, [-100.0, 0.0])
    assert nothing == 0.0
    assert 100.0 - made_up == pytest.approx(stays_behind)
