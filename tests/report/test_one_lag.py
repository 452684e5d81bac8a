"""The page has one lag to enter: the gap's, where it names one, else that of the estimate."""

from types import SimpleNamespace

import pytest

from advisor.oem.findings import line_of
from advisor.report.page.appendix import assumptions

NOTE = "The servo's lag is 0.143 ± 0.020 s, by which the estimate lags the command. For the aircraft file: "


def cause(in_model: bool) -> dict:
    size = {"lag_s": {"value": 0.129, "std": 0.00765}}
    return {"effect": "actuator_lag", "in_model": in_model, "parameters": size}


@pytest.mark.parametrize(
    ("gap", "entered"),
    [
        (None, "For the aircraft file: elevator: {lag_s: 0.143}"),
        ({"causes": [cause(in_model=False)]}, "For the aircraft file: elevator: {lag_s: 0.143}"),
        ({"causes": [cause(in_model=True)]}, "Put into the simulator what it lacks by the gap: 129 ± 15 ms."),
    ],
)
def test_the_lag_to_enter_is_that_of_the_gap_where_the_gap_names_one(gap, entered):
    estimate = SimpleNamespace(instrument=lambda name: SimpleNamespace(value=0.143))
    notes = [NOTE + line_of("servo_lag_s", 0.143), "Another note."]
    analysis = {"log": {"notes": []}, "model": {"notes": notes}}
    state = SimpleNamespace(model=estimate, flights=())
    content = SimpleNamespace(analysis=analysis, gap=gap, state=state, names=())
    (said,) = assumptions(content).blocks
    assert said.items == (NOTE.partition(" For the")[0] + " " + entered, "Another note.")
