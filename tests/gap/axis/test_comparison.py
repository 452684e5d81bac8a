"""The lateral derivatives of a simulator against those of a simulated flight."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Beta, SideControl
from advisor.flight.maneuvers.maneuver import Maneuver, Span
from advisor.flight.signals.record import Channel
from advisor.gap.axis import comparison
from advisor.gap.axis.comparison import compare_axis
from advisor.gap.result import Diagnosis, Gap, Value
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.estimator import estimate_axis
from advisor.oem.estimate import NoEstimate
from advisor.report.gap_document import axis_document
from tests.oem.axis.builders import JET, aileron_doublet, flown, rudder_doublet

KNOWN = SideControl(lag_s=0.0, delay_s=0.0)
AIRCRAFT = Aircraft(aileron=KNOWN, rudder=KNOWN, beta=Beta("none"))
T = np.arange(0.0, 8.0, 0.04)
TRUE = {name: JET[name] for name in ("L_p", "L_delta_a", "N_beta", "N_delta_r")}


def maneuvers():
    """Return two doublets of the aileron around one of the rudder."""
    rng = np.random.default_rng(9)
    measured = ("p", "r", "bank", "a_y")
    inputs = {"aileron": aileron_doublet(T)}, {"rudder": rudder_doublet(T)}, {"aileron": aileron_doublet(T)}
    return [
        numbered(number, flown(JET, **one, rng=rng, measured=measured, seconds=8.0, rate_hz=25.0))
        for number, one in enumerate(inputs, 1)
    ]


def numbered(number, record):
    known = {name: signal.at(T) for name, signal in record.given.items()}
    told = {name: signal.y for name, signal in (record.outputs | record.inputs).items()} | known
    channels = {name: Channel(name, T, y, "HIGHRES_IMU", "measured") for name, y in told.items()}
    return Maneuver(number, 0, Span(0.0, 1.0, 4.0, 8.0, "other", (), "quiet"), channels)


@pytest.fixture(scope="module")
def flight():
    return maneuvers()


def test_the_estimate_of_the_reading_is_not_made_again(flight, monkeypatch):
    logged = estimate_axis(LATERAL, flight, AIRCRAFT)
    monkeypatch.setattr(comparison, "estimate_axis", None)
    monkeypatch.setattr(comparison, "case_of", lambda *_: NoEstimate("none", "Nothing is diagnosed."))
    found = compare_axis(LATERAL, flight, replace(AIRCRAFT, model=TRUE), logged=logged, as_logged=True)
    assert {one.name: one.found.value for one in found.derivatives} == {n: logged.value(n) for n in TRUE}


@pytest.mark.study
def test_the_flights_own_numbers_leave_no_gap(flight):
    found = compare_axis(LATERAL, flight, replace(AIRCRAFT, model=TRUE))
    assert found.verdict == "none"
    assert {one.name for one in found.derivatives} == set(TRUE)


def test_a_weak_aileron_in_the_simulator_is_named_and_leaves_a_gap_on_unseen_flight(flight):
    found = compare_axis(
        LATERAL, flight, replace(AIRCRAFT, model=TRUE | {"L_delta_a": 0.8 * JET["L_delta_a"]})
    )
    assert found.verdict == "parameters"
    document = axis_document(found)
    changed = {one["derivative"]: one for one in document["parameters_changed"]}
    assert (
        max(found.derivatives, key=lambda d: abs(d.given - d.found.value) / d.found.std).name == "L_delta_a"
    )
    assert document["shrink"]["holdout"] == [1, 3]  # the second one alone moves the rudder
    assert document["shrink"]["percent"] > 80.0
    each = document["gap"]["by_maneuver"]
    assert [one["number"] for one in each] == [1, 2, 3]
    assert each[1]["after"] is None
    assert all(one["after"] < one["before"] for one in each[::2])
    low, high = changed["L_delta_a"]["ci95"]
    assert low < JET["L_delta_a"] < high


def test_a_file_without_lateral_numbers_has_no_verdict(flight, monkeypatch):
    monkeypatch.setattr(comparison, "diagnose_axis", lambda case, prior: None)
    found = compare_axis(LATERAL, flight[:2], AIRCRAFT)
    assert found.verdict == "untested"
    assert "give model.L_p" in found.sentence
    assert axis_document(found)["shrink"] is None


def test_a_derivative_that_the_log_contradicts_is_not_stated_as_changed(flight, monkeypatch):
    """The log's own estimate has the aileron of the simulator, 20 % weaker than that of the flight."""
    monkeypatch.setattr(comparison, "diagnose_axis", lambda case, prior: None)
    weak = replace(AIRCRAFT, model={"L_delta_a": 0.8 * JET["L_delta_a"]})
    logged = comparison.estimate_axis(LATERAL, flight, AIRCRAFT)
    other = replace(logged, theta=0.8 * logged.theta)
    assert [
        compare_axis(LATERAL, flight, weak, logged=one).derivatives[0].differs for one in (None, other)
    ] == [
        True,
        False,
    ]
    untold = replace(logged, not_identifiable={"L_delta_a": "no aileron moved"})
    assert compare_axis(LATERAL, flight, weak, logged=untold).derivatives == ()


@pytest.mark.parametrize(("verdict", "own"), [("effect", True), ("parameters", False)])
def test_beside_an_effect_the_derivatives_are_those_of_the_model_with_the_effect(
    flight, monkeypatch, verdict, own
):
    values = {name: Value(1.0, 0.5) for name in TRUE}
    named = Diagnosis(axis="lateral", verdict=verdict, sentence="", gap=Gap(), model=values)
    monkeypatch.setattr(comparison, "diagnose_axis", lambda case, prior: named)
    found = compare_axis(LATERAL, flight, replace(AIRCRAFT, model=TRUE))
    assert len(found.derivatives) == len(TRUE)
    assert all((one.found == Value(1.0, 0.5)) is own for one in found.derivatives)
