"""An effect is sought from the flight's derivatives and from the file's, each in its own hill."""

from types import SimpleNamespace

import pytest

from advisor.gap.fitting.prior import ERROR_IF_RIGHT
from advisor.gap.inference import pitch
from advisor.gap.inference.pitch import PitchFlight

LAG = SimpleNamespace(effect="actuator_lag")


@pytest.mark.parametrize("better", ["the flight", "the file"])
def test_an_effect_keeps_the_better_of_its_searches_from_the_flight_and_from_the_file(monkeypatch, better):
    def fit(problem, point, noise, *_, **__):
        return SimpleNamespace(cost=5.0 if point == better else 20.0, point=point, noise=noise)

    def screen(problem, fitted):
        lag = SimpleNamespace(variant=LAG, name="actuator_lag", point=problem, noise=1.0, price=1.0, cost=1.0)
        return SimpleNamespace(quick_fits=lambda table: [lag] if table else [])

    def within(tolerance):
        return "the file" if tolerance == ERROR_IF_RIGHT else "the flight"

    monkeypatch.setattr(pitch, "fit", fit)
    monkeypatch.setattr(pitch, "temperature", lambda *_: 1.0)
    monkeypatch.setattr(pitch, "Screen", screen)
    monkeypatch.setattr(pitch, "_without_the_effect", lambda loose, plain, fits: plain)
    monkeypatch.setattr(PitchFlight, "model_of", lambda self, problem, variant, made, *_, **__: made.point)
    monkeypatch.setattr(PitchFlight, "_beside", lambda self, base: self.table)
    flight = PitchFlight(
        SimpleNamespace(within=within, is_stated=True), SimpleNamespace(point="plain", noise=1.0), [LAG], []
    )
    assert flight.explained(None, 6)[1] == ["plain", better]
