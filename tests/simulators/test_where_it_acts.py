"""Numbers are fitted where the simulator and its surrogate both have the effects that were found."""

from dataclasses import replace
from functools import cache
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.diagnose import Examined
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.fitting.fit import fit
from advisor.gap.fitting.holdout import hold_out
from advisor.gap.fitting.problem import EffectProblem, SearchPoint
from advisor.gap.inference.evidence import FlightProblem
from advisor.gap.inference.pitch import PitchModel
from advisor.gap.records.prepare import prepare
from advisor.gap.simulator.layout import DERIVATIVES, ENTRIES, INDEX, NUISANCES, OUTPUTS
from advisor.oem.rows import Signal
from advisor.simulators.as_given import AsGiven, Flying, beyond
from advisor.simulators.improved import where_it_acts
from advisor.simulators.surrogate import Surrogate
from tests.simulators.nonlinear import Nonlinear, flown

MODEL = dict(zip(DERIVATIVES, (-2.7, 0.02, -0.15, -23.0, -3.4, -29.0), strict=True))
LAG_S = 0.1
FOUND = SimpleNamespace(
    verdict="effect",
    shrink=SimpleNamespace(beyond_air_percent=None, by_numbers_percent=None),
    causes=(SimpleNamespace(present=True, block="input"),),
    effects={"actuator_lag": {"lag_s": LAG_S}},
)


@cache
def flying(own_lag_s: float = 0.0) -> Flying:
    """Return a simulator with two manoeuvres of an aircraft whose servo lags."""
    flights = prepare(flown(Nonlinear(lag_s=LAG_S), maneuvers=2), Aircraft())
    simulator, heights = Nonlinear(lag_s=own_lag_s), {1: 300.0, 2: 300.0}
    return Flying(simulator, flights, heights, {1: {}, 2: {}}, None, lambda *_: None)


def differences(own_lag_s: float, surrogates_lag_s: float) -> list[np.ndarray]:
    """Return the outputs of the simulator minus those of its surrogate, each with its own lag."""
    here = flying(own_lag_s)
    p = np.zeros((2, len(ENTRIES)))
    p[:, : len(MODEL)] = list(MODEL.values())
    replays = here.replays(p, held=False)
    p[:, INDEX["lag_s"]] = surrogates_lag_s
    return beyond(here, replays, p)


def test_the_numbers_are_fitted_next_to_the_simulator_with_its_effects():
    here, as_given = flying(), differences(0.0, 0.0)
    problem = EffectProblem(here.flights, np.zeros(len(ENTRIES)))
    own = np.zeros((2, len(NUISANCES)))
    point = SearchPoint(np.array(list(MODEL.values())), own).with_effect(LAG, (LAG_S,))
    last = SimpleNamespace(fitted=SimpleNamespace(point=point))
    seen = []
    whole = Examined(FOUND, SimpleNamespace(problem=problem, last=last), seen_in=seen.append)
    began = zip(here.as_flown(here.replays(np.zeros((2, len(ENTRIES))), False)), as_given, strict=True)
    as_flown = {there.number: AsGiven(there, grid) for there, grid in began}
    where_it_acts(whole, here, Surrogate(MODEL, here.flights.reference_m_s), as_flown)
    channel = OUTPUTS.index("a_z")
    with_lag = differences(LAG_S, LAG_S)
    for one, other, due, was in zip(
        here.flights.flights, seen[0].flights.flights, with_lag, as_given, strict=True
    ):
        t = one.outputs["a_z"].t
        moved = one.outputs["a_z"].y - other.outputs["a_z"].y
        due, was = (np.interp(t, np.arange(x.shape[1]) * one.h, x[channel]) for x in (due, was))
        assert np.max(np.abs(moved - (due - was))) < 0.1 * np.max(np.abs(due - was))


@pytest.mark.parametrize(("effects", "flies"), [({}, 0), ({"actuator_lag": {"lag_s": LAG_S}}, 2)])
def test_a_simulator_flies_again_where_its_motion_changes_and_without_increments(effects, flies):
    increments = []

    class Watched(Nonlinear):
        def replay(self, condition, inputs, added=None):
            increments.append(added)
            return super().replay(condition, inputs, added)

    here, as_given = replace(flying(), simulator=Watched()), differences(0.0, 0.0)
    flown_once = here.as_flown(here.replays(np.zeros((2, len(ENTRIES))), False))
    increments.clear()
    stiffer = SearchPoint(1.1 * np.array(list(MODEL.values())), np.zeros((2, len(NUISANCES))))
    last = SimpleNamespace(fitted=SimpleNamespace(point=stiffer.with_effect(LAG, (LAG_S,))))
    findings = SimpleNamespace(problem=EffectProblem(here.flights, np.zeros(len(ENTRIES))), last=last)
    diagnosis = SimpleNamespace(**{**vars(FOUND), "effects": effects})
    whole = Examined(diagnosis, findings, seen_in=lambda seen: "fitted again")
    as_flown = {there.number: AsGiven(there, grid) for there, grid in zip(flown_once, as_given, strict=True)}
    told = where_it_acts(whole, here, Surrogate(MODEL, here.flights.reference_m_s), as_flown)
    assert increments == [None] * flies
    assert (told == "fitted again") == bool(flies)


def noisier(flights, by: float):
    """Return manoeuvres with more noise in the pitch rate."""
    rng = np.random.default_rng(7)
    louder = []
    for one in flights.flights:
        q = one.outputs["q"]
        noise = by * rng.standard_normal(len(q.y))
        louder.append(replace(one, outputs={**one.outputs, "q": Signal(q.t, q.y + noise)}))
    return replace(flights, flights=tuple(louder))


@pytest.mark.parametrize("quieter", [True, False])
def test_the_likelier_numbers_stay(quieter):
    flights = flying().flights
    first, second = (flights, noisier(flights, 0.02))[:: -1 if quieter else 1]
    plain = EffectProblem(first, np.zeros(len(ENTRIES)))
    start = SearchPoint(np.array(list(MODEL.values())), np.zeros((2, len(NUISANCES))))
    made = fit(plain, start.with_effect(LAG, (LAG_S,)))
    model = PitchModel(
        alternative=None, variant=None, problem=FlightProblem.of(plain, made), fitted=made,
        held_out=hold_out(plain, made), evidence=None, natural=None, likelihood=0.0, change=0.0,
    )  # fmt: skip
    stays = model.seen_in(replace(plain, flights=second))
    assert (stays.problem.flights is second) == quieter
    assert (stays.fitted.cost < made.cost) == quieter
