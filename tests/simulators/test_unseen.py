"""Shrink on manoeuvres that the fit has not used, and models refitted within reason."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.fitting import refit
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, NUISANCES, SPEED
from advisor.simulators import unseen
from advisor.simulators.unseen import changes_something, kept_apart
from tests.gap.test_report_screen import EVIDENCE, diagnosis
from tests.simulators.nonlinear import flown

MODEL = dict(zip(DERIVATIVES, (-2.7, 0.02, -0.15, -23.0, -3.4, -29.0), strict=True))


@pytest.mark.parametrize(
    ("flown", "holdout", "kept"),
    [(9, None, (1, 4, 7)), (4, None, (1,)), (3, None, (1,)), (9, 2, (7, 8)), (2, None, ()), (3, 2, ())],
)
def test_a_third_is_kept_apart_unless_too_few_remain_for_a_fit(flown, holdout, kept):
    assert kept_apart(flown, holdout) == kept


def test_the_fits_never_meet_the_manoeuvres_kept_apart(monkeypatch):
    left_out = []
    monkeypatch.setattr(unseen, "sized_without", lambda _, apart: left_out.extend(apart))
    numbered = [SimpleNamespace(number=n) for n in range(1, 7)]
    problem = SimpleNamespace(flights=SimpleNamespace(flights=numbered))
    found = unseen.unseen_of(SimpleNamespace(findings=SimpleNamespace(problem=problem)), None)
    assert found.kept == (1, 4)
    assert left_out == [2, 5]


def said(block: str, verdict: str = "effect", **shrink: float | None):
    whole = {"beyond_air_percent": None, "by_numbers_percent": None, **shrink}
    cause = SimpleNamespace(present=True, block=block)
    return SimpleNamespace(verdict=verdict, causes=[cause], shrink=SimpleNamespace(**whole))


def test_moving_air_alone_changes_nothing_in_a_simulator():
    assert not changes_something(said("air"))
    assert changes_something(said("input"))
    assert changes_something(said("air", beyond_air_percent=12.0))
    assert changes_something(said("air", verdict="parameters"))


def test_a_sentence_with_another_shrink_keeps_its_doubt():
    found = diagnosis(verdict="effect", evidence=EVIDENCE)
    resaid = unseen.resaid(found, None, Aircraft())
    assert resaid.sentence.startswith("Likely, the simulator responds 30 ms too early")


def test_natural_numbers_of_a_corrected_file_start_from_its_own_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    # From the fit without the effect, a latency at its bound ended 39 ms off next to a delay of 60 ms.
    started: list[str] = []

    def predicted(problem, model, fitted, floor, kept, offset_rad):
        started.append(fitted.name)
        return SimpleNamespace(mean_square=np.ones(4))

    def fit(name):
        point = SimpleNamespace(own=None)
        return SimpleNamespace(fitted=SimpleNamespace(name=name, point=point))

    plain, corrected = fit("plain"), fit("corrected")
    findings = SimpleNamespace(
        problem=SimpleNamespace(prior_derivatives=np.zeros(6)), models=[plain, corrected], last=corrected
    )
    examined = SimpleNamespace(diagnosis=None, findings=findings)
    monkeypatch.setattr(unseen, "predicted", predicted)
    monkeypatch.setattr(unseen, "changes_something", lambda _: True)
    monkeypatch.setattr(unseen, "unknown_offset", lambda *_: 0.0)
    monkeypatch.setattr(unseen, "as_changed", lambda *_: None)
    monkeypatch.setattr(unseen, "floor_of", lambda _: np.ones(4))
    unseen.by_the_file(examined, unseen.UnseenManeuvers((0,), examined))
    assert started == ["plain", "corrected"]


def wrong_model() -> tuple[EffectProblem, SearchPoint]:
    """Return manoeuvres next to a model that diverges, from an initial state that no aircraft had."""
    flights = prepare(flown(maneuvers=2), Aircraft())
    problem = EffectProblem(flights, np.zeros(len(ENTRIES)))
    derivatives = np.array(list((MODEL | {"M_alpha": 6.0, "M_q": 0.5}).values()))
    return problem, SearchPoint(derivatives, np.full((len(flights), len(NUISANCES)), 5.0))


def test_a_model_that_does_not_fit_gets_no_initial_state_that_no_aircraft_had(monkeypatch):
    problem, point = wrong_model()
    simulated = []
    linearise = refit.linearise

    def seen(problem, point, **how):
        simulated.append(point.own)
        return linearise(problem, point, **how)

    monkeypatch.setattr(refit, "linearise", seen)
    refit.own_refitted(problem, point, problem.flights.white)
    lift = [9.80665 / np.mean(f.slow[SPEED]) for f in problem.flights.flights]
    for own in simulated:
        assert np.all(np.abs(own[:, 0]) <= np.radians(6.0))
        assert np.all(np.abs(own[:, 2] + lift) <= 0.31 * np.array(lift))


def test_refitting_never_leaves_more_than_steady_flight_does():
    problem, point = wrong_model()
    noise = problem.flights.white
    steady = np.array([[0.0, 0.0, f.level_lift, 0.0] for f in problem.flights.flights])
    p = problem.driving(replace(point, own=steady))
    found = refit.own_refitted(problem, point, noise)
    for i, flight in enumerate(problem.flights.flights):
        as_it_is = problem.measured(flight) - problem.read(flight, problem.fly(flight, p[i]), p[i])
        costs = [
            sum(
                float(np.sum((r[rows] / s) ** 2)) for rows, s in zip(problem.rows(flight), noise, strict=True)
            )
            for r in (found.residuals[i], as_it_is)
        ]
        assert costs[0] <= costs[1]
