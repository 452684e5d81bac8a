"""Derivatives through a user's simulator agree with the estimate of the same log, or are not stated."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.analysis import gap as reading
from advisor.analysis.gap_flights import GapFlights
from advisor.gap.result import ComparedDerivative, Value
from advisor.oem.estimate import NoEstimate
from advisor.simulators.compare import Compared, agreeing
from tests.exports.models.test_orders import found
from tests.simulators.nonlinear import Nonlinear, flown

OWN = Value(0.27, 0.045)
LOGGED = SimpleNamespace(
    names=("Z_delta_e", "M_q"), theta=np.array([0.71, -4.0]), std=np.array([0.10, 0.2]), not_identifiable={}
)
"""Z_δe and M_q of arduplane-calm by a simulator without its servo, and by the estimate of the log."""


def diagnosis():
    """Return a diagnosis with both derivatives, the first one far below that of simulator and log."""
    compared = (ComparedDerivative("Z_delta_e", 0.71, OWN), ComparedDerivative("M_q", -5.0, Value(-4.1, 0.1)))
    model = {one.name: one.found for one in compared}
    return replace(found(), model={**found().model, **model}, derivatives=compared)


def test_two_readings_of_one_log_agree_within_their_intervals():
    wider = OWN.agreeing(Value(0.71, 0.10))
    assert wider.value + 1.96 * wider.std == pytest.approx(0.71 + 1.96 * 0.10, abs=1e-3)
    assert Value(0.6, 0.045).agreeing(Value(0.71, 0.10)) == Value(0.6, 0.045)


def test_a_derivative_that_the_log_contradicts_is_not_stated_as_changed_and_the_notes_name_it():
    assert [one.name for one in diagnosis().derivatives if one.differs] == ["Z_delta_e", "M_q"]
    told = agreeing(diagnosis(), LOGGED)
    assert [one.name for one in told.derivatives if one.differs] == ["M_q"]
    assert told.model["Z_delta_e"].std > 4.0 * OWN.std
    assert told.model["M_q"] == Value(-4.1, 0.1)
    assert told.notes[-1] == "The intervals of Z_δe contain those of advisor analyze, which lie elsewhere."


def test_a_log_without_an_estimate_contradicts_nothing():
    untold = SimpleNamespace(**{**vars(LOGGED), "not_identifiable": {"Z_delta_e": "correlated"}})
    for logged in (NoEstimate("few", "too few"), untold):
        assert agreeing(diagnosis(), logged).derivatives == diagnosis().derivatives


@pytest.mark.parametrize("kind", ["user's", "file's"])
def test_derivatives_agree_with_the_log_next_to_a_users_simulator(kind, monkeypatch):
    """The aircraft file's own model is its surrogate, so that nothing is subtracted from the log."""
    simulator = Nonlinear() if kind == "user's" else None
    monkeypatch.setattr(reading, "compare", lambda *_: Compared(diagnosis(), Aircraft()))
    monkeypatch.setattr(reading, "compare_to_file", lambda *_: Compared(diagnosis(), Aircraft()))
    monkeypatch.setattr(reading, "estimate_jointly", lambda *_: LOGGED)
    told = reading.compare_flown(GapFlights(flown(maneuvers=2), 0, ()), Aircraft(), simulator).diagnosis
    assert (told.model["Z_delta_e"] == OWN) == (kind == "file's")
