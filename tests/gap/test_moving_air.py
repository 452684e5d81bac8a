"""The air moves where a gust angle is large enough to be one."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft_file.read import load_aircraft
from advisor.analysis.gap_flights import maneuvers_of
from advisor.gap.records.prepare import prepare
from advisor.gap.search import air
from advisor.gap.search.air import moving_air
from advisor.gap.search.baseline import fit_baseline
from tests.flights import SHIPPED, calm_two


def test_a_rest_of_the_model_that_gusts_imitate_is_no_cause():
    aircraft = load_aircraft(SHIPPED / "arduplane-calm.yaml")
    flights = prepare(maneuvers_of([calm_two()], aircraft).maneuvers, aircraft)
    sought = moving_air(*fit_baseline(flights, aircraft))
    assert sought.gain > 30.0
    assert sought.found is None or sought.found.is_natural


@pytest.mark.parametrize(
    ("in_quiet_rad", "nats"),
    [(0.01, 0.0), (0.02, 0.0), (0.005, -0.5 * np.log(2.0) ** 2 / (1 / 20 + 1 / 100)), (0.0, -44.18)],
    ids=["as strong", "stronger", "half as strong", "still"],
)
def test_turbulence_that_rests_with_the_elevator_is_unlikely(monkeypatch, in_quiet_rad: float, nats: float):
    """Correlated over 1 s: 10 independent squares in 10 s of rest, 50 in five manoeuvres of 10 s."""
    monkeypatch.setattr(air, "quiet_rows", lambda *_: [SimpleNamespace(t=np.array([0.0, 10.0]))])
    monkeypatch.setattr(air, "find_turbulence", lambda *_: SimpleNamespace(gust_angle=in_quiet_rad))
    monkeypatch.setattr(air, "instrument_noise", lambda _: None)
    flights = SimpleNamespace(flights=[SimpleNamespace(duration_s=10.0)] * 5)
    found = SimpleNamespace(gust_angle=0.01, noise=SimpleNamespace(gust_memory_s=1.0))
    assert air._steady(SimpleNamespace(flights=flights), None, found) == pytest.approx(nats, rel=1e-3)
