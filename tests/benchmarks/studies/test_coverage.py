"""The study of faulty instruments: its draws, its counts, and one flight of it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from advisor.flight.signals.trust import InstrumentFinding
from benchmarks.studies import covered, reports
from benchmarks.studies.covered import NAMED, Drawn, Errors, Outcome, Stop, draws

SOUND = Errors(1.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0, 0.1)
HELD = dict.fromkeys(NAMED, 0.5)
GOOD = Stop(2, 0.4, 0.6)


def finding(quantity: Any, stated: float | str | None, value: float | str) -> InstrumentFinding:
    return InstrumentFinding("elevator", quantity, stated, value, contradicts=True)


def drawn(statement: covered.Statement) -> Drawn:
    return Drawn("uav", statement, (0, 1))


def report(*outcomes: Outcome) -> dict[str, Any]:
    return dict(reports.coverage(len(outcomes), 1).report(outcomes).document)


def test_equal_seeds_give_equal_errors_and_other_seeds_others() -> None:
    assert [d.errors for d in draws(12, 3)] == [d.errors for d in draws(12, 3)]
    assert not {d.errors for d in draws(12, 3)} & {d.errors for d in draws(12, 4)}


def test_a_third_of_the_campaigns_states_no_lag_a_third_the_true_one_a_third_one_that_is_far_off() -> None:
    errors = {said: [d.errors for d in draws(60, 1) if d.statement == said] for said in covered.STATEMENTS}
    assert {said: len(found) for said, found in errors.items()} == dict.fromkeys(covered.STATEMENTS, 20)
    assert all(e.stated_lag_s is None for e in errors["unknown"])
    assert all(e.stated_lag_s == e.lag_s for e in errors["right"])
    off = [(e.stated_lag_s or 0.0) / e.lag_s - 1.0 for e in errors["wrong"]]
    assert all(0.3 <= abs(error) <= 0.6 for error in off)
    assert min(off) < -0.4 < 0.4 < max(off)
    assert all(Outcome(d, 7, HELD, None, (), ()).far_off is (d.statement == "wrong") for d in draws(60, 1))


def test_every_error_stays_within_its_prior() -> None:
    found = [d.errors for d in draws(60, 2)]
    assert all(0.5 <= e.noise_percent <= 5.0 for e in found)
    assert all(abs(e.command_late_s) <= 0.01 and abs(e.airspeed_scale - 1.0) <= 0.05 for e in found)
    assert all((e.alpha_late_s > 0.0) != (e.arm_m > 0.0) for e in found)
    assert max(e.alpha_late_s for e in found) == pytest.approx(0.09, abs=0.01)


@pytest.mark.parametrize(
    ("told", "true"),
    [
        (finding("lag_s", 0.05, 0.09), True),
        (finding("lag_s", 0.1, 0.13), False),
        (finding("delay_s", None, 0.02), False),
        (finding("sign", None, -1.0), False),
        (finding("unit", "us", "counts"), False),
    ],
)
def test_a_contradiction_is_right_where_the_truth_is_nearer_to_it_than_to_the_statement(told, true):
    assert SOUND.confirms(told) is true


def test_a_stop_is_false_where_the_response_or_a_named_derivative_is_beyond_its_tolerance() -> None:
    assert [GOOD.false, Stop(2, 1.2, 0.1).false, Stop(2, 0.1, 1.2).false] == [False, True, True]


def test_the_report_counts_intervals_that_hold_among_campaigns_with_a_model() -> None:
    held = Outcome(drawn("right"), 7, HELD, GOOD, (), ())
    missed = replace(held, off=HELD | {"M_q": -1.3})
    nothing = replace(held, off={}, stop=None)
    document = report(held, missed, nothing)
    assert document["coverage_percent"]["all"] == dict.fromkeys(NAMED, 100.0) | {"M_q": 50.0}
    assert document["coverage_percent"]["unknown"] == {}
    assert (document["stops"], document["false_stops"]) == (2, 0)


def test_the_report_counts_stops_and_contradictions_where_the_stated_lag_is_far_off() -> None:
    near = Outcome(drawn("right"), 7, HELD, GOOD, (), ("alpha_scale",))
    believed = Outcome(drawn("wrong"), 7, HELD, Stop(2, 3.0, 2.0), (), ())
    seen = replace(believed, stop=None, right=("elevator_lag_s",))
    document = report(near, believed, seen)
    counts = {"campaigns": 2, "stops": 1, "false_stops": 1, "contradicted": 1}
    assert document["lag_far_off"] == counts
    assert document["contradictions"] == {"right": {"elevator_lag_s": 1}, "wrong": {"alpha_scale": 1}}


def test_the_true_derivatives_at_a_stop_have_no_error() -> None:
    truth = np.array([0.0, -3.9, 0.0, -0.2, 0.0, -45.0, -4.5, -70.0])
    scenario = covered.Scenario()
    assert covered.response_error_percent(truth, truth, scenario) == pytest.approx(0.0, abs=1e-9)
    stronger = truth * np.array([1, 1, 1, 1, 1, 1, 1, 1.1])
    assert covered.response_error_percent(stronger, truth, scenario) == pytest.approx(10.0, abs=1.0)


@pytest.mark.study
def test_a_flown_campaign_has_a_model_and_an_error_of_every_named_derivative() -> None:
    outcome = covered.fly(draws(10, 1)[3])
    assert outcome.accepted >= 5
    assert set(outcome.off) == set(NAMED)
