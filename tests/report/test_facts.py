"""Whether a fact has numbers, what it is estimated from, and what the nuisance parameters are called."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace

import pytest

from advisor.oem.estimate import InstrumentEstimate
from advisor.report.facts.estimates import Fact, instrument_facts, of_all, of_one
from tests.campaign.states import changed
from tests.decision.campaigns import estimate
from tests.tui import flights


@pytest.mark.parametrize(
    ("value", "half", "known"), [(1.0, 0.1, True), (1.0, nan, False), (nan, 0.1, False), (nan, nan, False)]
)
def test_a_fact_is_known_with_both_its_value_and_its_interval(value, half, known):
    assert Fact(name="M_α", source="", value=value, half=half).is_known is known


@pytest.mark.parametrize(
    ("provenance", "name"),
    [
        ("vane", "vane ahead of the centre of gravity"),
        ("derived", "apparent distance of the α vane ahead of the centre of gravity"),
    ],
)
def test_an_aircraft_without_a_vane_has_no_vane_arm_among_its_nuisance_parameters(provenance, name):
    found = replace(estimate(), instruments=(InstrumentEstimate("vane_arm_m", -0.17, 0.05, None),))
    told = changed(flights.state(), model=found, channels={"alpha": SimpleNamespace(provenance=provenance)})
    assert [fact.name for fact, _ in instrument_facts(told)] == [name]


def test_the_joint_number_and_that_of_one_manoeuvre_name_their_sources():
    state = changed(flights.state(3, bad=(2,)), estimate_from=(1, 3))
    joint, alone = of_all("M_alpha", state, {}), of_one("M_alpha", state.maneuvers[2], {})
    assert joint.name == alone.name == "M_α"
    assert joint.source == "Joint estimate from manoeuvres 1, 3"
    assert alone.source == "Estimate from manoeuvre 3 alone"
