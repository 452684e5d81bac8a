"""Side gusts and coloured instruments in residuals made by hand, and the stage that weighs them."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.reference import SIDE_PARAMETERS
from advisor.gap.inference.prior import FIELD
from advisor.side_gap import stage
from advisor.side_gap.disturbance import courses_of
from advisor.side_gap.evidence import Gain
from advisor.side_gap.fit import fitted
from advisor.side_gap.gusts import Gusts, coloured_likelihood, side_gusts
from advisor.side_gap.models import case_of
from advisor.side_gap.stage import Tried, stage_of
from tests.oem.lateral_builders import JET
from tests.side_gap.test_comparison import AIRCRAFT, maneuvers

ANGLE = 0.01
NOISE = np.array([0.003, 0.001, 0.002, 0.03, 1.0])
GUSTS = Gusts(NOISE, ANGLE, 0.001, 0.0)


@pytest.fixture(scope="module")
def case():
    model = replace(AIRCRAFT, model=dict(JET))
    return case_of(maneuvers(), model, np.array([JET[name] for name in SIDE_PARAMETERS]))


@pytest.fixture(scope="module")
def flight(case):
    """Return a fit with the true derivatives, and what gusts change in its manoeuvres."""
    fit = fitted(case.flown, case.begin, case.natural, case.known(1e-6, case.natural), rounds=1)
    return fit, courses_of(fit, case.flown)


def with_residual(fit, residual):
    white = NOISE[fit.assembly.channel] * np.random.default_rng(2).standard_normal(len(residual))
    return replace(fit, fitted=fit.assembly.z - white - residual, noise=NOISE)


def wandering(n, memory, rng):
    x = np.zeros(n)
    for i in range(1, n):
        x[i] = memory * x[i - 1] + np.sqrt(1.0 - memory**2) * rng.standard_normal()
    return x


def test_a_gust_angle_enters_all_outputs_and_its_size_is_found(flight):
    fit, courses = flight
    rng = np.random.default_rng(3)
    blown = [ANGLE * course.columns @ wandering(len(course.knots), 0.9, rng) for course in courses]
    gusty = with_residual(fit, np.concatenate(blown))
    found = side_gusts(gusty, courses)
    assert found.angle == pytest.approx(ANGLE, rel=0.4)
    assert abs(found.angle - ANGLE) < 4.0 * found.angle_std
    assert found.likelihood > coloured_likelihood(gusty) + 20.0


def test_a_coloured_instrument_is_no_gust(flight):
    fit, courses = flight
    rng = np.random.default_rng(4)
    left = np.zeros(len(fit.fitted))
    for named in fit.assembly.rows:
        rows = named["r"]
        left[rows] = 0.004 * wandering(rows.stop - rows.start, 0.95, rng)
    coloured = with_residual(fit, left)
    assert side_gusts(coloured, courses).likelihood < coloured_likelihood(coloured) - 20.0


def test_still_air_has_no_gusts(flight):
    fit, courses = flight
    still = with_residual(fit, np.zeros(len(fit.fitted)))
    found = side_gusts(still, courses)
    assert found.angle < 0.1 * ANGLE
    assert found.likelihood == pytest.approx(coloured_likelihood(still), abs=15.0)


def staged(case, fit, monkeypatch, gains, evidence=(-5.0, -5.0)):
    """Return a stage with one effect of known evidence, and with known gains of gusts."""
    effect = SimpleNamespace(
        name="rudder_transport_delay",
        places=(("rudder", "delay_s"),),
        variant=SimpleNamespace(names=("delay_s",)),
    )
    other = replace(fit)
    tried = Tried(effect, other, *evidence, Gain(1.0, 1.0))
    monkeypatch.setattr(stage, "log_evidence", lambda *_: -10.0)
    monkeypatch.setattr(stage, "best_start", lambda *_: SimpleNamespace(squares=0.0, point=None))
    monkeypatch.setattr(stage, "_tried", lambda *_: tried)
    monkeypatch.setattr(stage, "courses_of", lambda *_: ())
    monkeypatch.setattr(stage, "_in_gusts", lambda one, _: (GUSTS, gains[one is other]))
    return stage_of(case, fit, 1.0, [effect], FIELD)


def test_in_still_air_the_likelier_effect_is_found(case, flight, monkeypatch):
    told = staged(case, flight[0], monkeypatch, (-40.0, -40.0))
    assert told.found.effect.name == "rudder_transport_delay"
    assert told.air < 1e-6


def test_gusts_that_explain_the_residual_take_the_effect_its_probability(case, flight, monkeypatch):
    told = staged(case, flight[0], monkeypatch, (60.0, 20.0))
    assert told.found is None
    assert told.air > 0.5
    total = told.none + told.parameters + told.air + sum(told.probability.values())
    assert total == pytest.approx(1.0)


def test_an_effect_that_gains_as_much_in_gusts_stays_the_answer(case, flight, monkeypatch):
    told = staged(case, flight[0], monkeypatch, (60.0, 60.0))
    assert told.found.effect.name == "rudder_transport_delay"


def test_gusts_as_small_as_in_any_flight_are_no_cause(case, flight, monkeypatch):
    monkeypatch.setattr(stage, "NATURAL_GUST_ANGLE", 2.0 * ANGLE)
    told = staged(case, flight[0], monkeypatch, (60.0, 20.0))
    assert told.air == 0.0
    assert told.none > 0.5


@pytest.mark.parametrize(("apart", "stays_behind"), [(0.0, 0.0), (0.0025, 5.0), (0.05, 100.0)])
def test_models_closer_than_a_simulators_own_error_differ_by_few_nats(monkeypatch, apart, stays_behind):
    """The error is half a per cent of the peak: 20 nats at its size, and what the data say beyond."""
    monkeypatch.setattr(stage, "change_of", lambda one, other: 0.0 if one is other else apart)
    plain, late = SimpleNamespace(likelihood=-100.0), SimpleNamespace(likelihood=0.0)
    monkeypatch.setattr(stage, "form_error", lambda names, change: 0.0)
    made_up, nothing = stage.for_model_error([plain, late], [(), ("skew_s",)], 1.0)
    assert nothing == 0.0
    assert 100.0 - made_up == pytest.approx(stays_behind)
