"""Whether a fact has numbers to show, and what the nuisance parameters of an aircraft are called."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace

import pytest

from advisor.oem.estimate import InstrumentEstimate
from advisor.report.facts.estimates import instrument_facts
from advisor.report.facts.fact import Fact
from tests.decision.campaigns import estimate


@pytest.mark.parametrize(
    ("value", "half", "known"), [(1.0, 0.1, True), (1.0, nan, False), (nan, 0.1, False), (nan, nan, False)]
)
def test_a_fact_is_known_with_both_its_value_and_its_interval(value, half, known):
    assert Fact(name="M_α", value=value, half=half).is_known is known


@pytest.mark.parametrize(
    ("provenance", "name"),
    [
        ("vane", "vane ahead of the centre of gravity"),
        ("derived", "α reads like a vane ahead of the centre of gravity"),
    ],
)
def test_an_aircraft_without_a_vane_has_no_vane_arm_among_its_nuisance_parameters(provenance, name):
    found = replace(estimate(), instruments=(InstrumentEstimate("vane_arm_m", -0.17, 0.05, None),))
    channels = {"alpha": SimpleNamespace(provenance=provenance)}
    assert [fact.name for fact, _ in instrument_facts(found, channels)] == [name]
