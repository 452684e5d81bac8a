"""Whether a fact has numbers, what it is estimated from, and what the nuisance parameters are called."""

from dataclasses import replace
from math import nan
from types import SimpleNamespace

import pytest

from advisor.gap.result import Value
from advisor.gap.verdict.statements import what
from advisor.oem.estimate import InstrumentEstimate
from advisor.oem.notes import FOR_THE_FILE
from advisor.report.facts.estimates import Fact, instrument_facts, of_all, of_one
from advisor.report.gap_document import gap_document, next_steps
from advisor.report.page.render import entered_once
from tests.campaign.states import changed
from tests.decision.campaigns import estimate
from tests.gap.test_report_answer import DERIVATIVES
from tests.gap.test_report_screen import DELAY, diagnosis
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


LAG = replace(DELAY, effect="actuator_lag", parameters={"lag_s": Value(0.129, 0.00765)})


def test_the_lag_of_the_estimate_is_that_by_which_it_delays_the_command() -> None:
    found = replace(estimate(), instruments=(InstrumentEstimate("servo_lag_s", 0.143, 0.0102, None),))
    ((fact, stated),) = instrument_facts(changed(flights.state(), model=found))
    assert (fact.name, stated) == ("servo lag, by which the estimate delays the command", "–")
    assert fact.sentence == "143 ± 20 ms"


def test_the_lag_of_the_gap_is_what_the_simulator_lacks() -> None:
    found = diagnosis(causes=(LAG,), derivatives=DERIVATIVES)
    said = [what(LAG), next_steps(found, ["flight.tlog"], "mine.yaml")[0].text]
    assert said[0].endswith("it lacks 129 ms of servo lag")
    assert said[1].startswith("Put into the simulator what it lacks: actuator lag 129 ± 15 ms.")
    assert not any("aircraft file" in one for one in said)


def test_a_page_with_a_gap_in_the_servo_names_one_number_to_enter() -> None:
    note = f"The servo's lag is 0.143 s.{FOR_THE_FILE}elevator: {{lag_s: 0.143}}"
    vane = f"Alpha reads like a vane.{FOR_THE_FILE}alpha: {{vane_arm_m: 0.2}}"
    told = gap_document(diagnosis(causes=(replace(LAG, present=True),), derivatives=DERIVATIVES))
    assert entered_once(note, None) == note
    assert entered_once(vane, told) == vane
    said = entered_once(note, told)
    assert "lag_s: 0.143" not in said
    assert said.endswith("The section on the gap names the number to enter in the aircraft file.")
