"""Two lags of a servo answer two questions, and only that of the estimate is for the aircraft file."""

from dataclasses import replace

from advisor.gap.result import Value
from advisor.gap.verdict.statements import what
from advisor.oem.estimate import InstrumentEstimate
from advisor.report.facts.estimates import instrument_facts
from advisor.report.gap_steps import next_steps
from tests.campaign.states import changed
from tests.decision.campaigns import estimate
from tests.gap.test_report_answer import DERIVATIVES
from tests.gap.test_report_screen import DELAY, diagnosis
from tests.tui import flights

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
