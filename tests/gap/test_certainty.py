"""The title over an answer, its sentence and its first step are as sure as its probability."""

from dataclasses import replace

import pytest

from advisor.gap.alternative import Alternative, AlternativeEvidence, Column, Contribution
from advisor.gap.verdict.text import answers_of
from advisor.report.facts.answers import by_flight_alone, is_turned, title_of
from advisor.report.gap_document import next_steps
from advisor.words.certainty import as_sure
from tests.gap.test_report_screen import diagnosis, printed

DELAY = Alternative("effect", "transport_delay", "input")
LAG = Alternative("effect", "actuator_lag", "input")
NOTHING = Alternative("none", "none")
LIFT, MOMENT = (Alternative("unknown", "unknown", b) for b in ("force_equation", "moment_equation"))


def evidence(*shares):
    return tuple(AlternativeEvidence(alternative, (), p) for alternative, p in shares)


def box(found, columns=80):
    return printed(found, columns)[0]


@pytest.mark.parametrize(
    ("kind", "probability", "said"),
    [
        ("effect", 0.9, "CAUSE FOUND"),
        ("effect", 0.89, "LIKELY CAUSE"),
        ("effect", 0.6, "LIKELY CAUSE"),
        ("effect", 0.59, "NOT DECIDED BETWEEN A AND B"),
        ("parameters", 0.95, "WRONG NUMBERS"),
        ("parameters", 0.7, "LIKELY WRONG NUMBERS"),
        ("unknown", 0.7, "LIKELY UNKNOWN CAUSE"),
        ("none", 0.7, "LIKELY NOTHING TO CORRECT"),
        ("untested", 0.7, "NOTHING TO COMPARE WITH"),
    ],
)
def test_the_title_follows_the_size_of_the_largest_probability(kind, probability, said):
    a, b = Alternative("effect", "a"), Alternative("effect", "b")
    assert (
        title_of(diagnosis(verdict=kind, evidence=evidence((a, probability), (b, 1.0 - probability)))) == said
    )


def before(name, nats):
    return (Column(name, nats, "nats", "prior probability of each answer"),)


def test_what_the_frequency_before_the_flight_turned_is_likely_and_never_found():
    turned = (
        AlternativeEvidence(DELAY, before("prior", 0.0), 0.95),
        AlternativeEvidence(NOTHING, before("prior", -4.0), 0.05),
    )
    assert is_turned(turned)
    assert title_of(diagnosis(evidence=turned)) == "LIKELY CAUSE"
    assert dict(by_flight_alone(turned))["transport delay"] == pytest.approx(0.2582, abs=1e-3)
    sure = (turned[0], replace(turned[1], columns=before("prior", 0.0)))
    assert title_of(diagnosis(evidence=sure)) == "CAUSE FOUND"


def test_no_gap_is_the_title_only_where_none_lies_above_the_noise():
    sure = evidence((NOTHING, 1.0))
    found = diagnosis(verdict="none", causes=(), evidence=sure)
    free = replace(found, gap=replace(found.gap, before=0.02))
    assert title_of(free) == "NO GAP"
    assert title_of(found) == "NOTHING TO CORRECT"
    assert "no gap" not in "\n".join(printed(found, 80)).lower()


def test_blocks_of_the_unknown_count_together():
    told = evidence((DELAY, 0.4), (LIFT, 0.35), (MOMENT, 0.25))
    assert answers_of(told)[0] == ("something without a name in the lift", pytest.approx(0.6))


def test_an_undecided_answer_is_a_sentence_with_both_and_claims_neither():
    answers = [("transport delay", 0.55), ("actuator lag", 0.44)]
    said = as_sure("The real aircraft answers 30 ms too late.", answers)
    assert said == "Not decided between transport delay (55 %) and actuator lag (44 %)."


def test_a_likely_answer_says_so_in_its_sentence():
    assert as_sure("The servo lags.", [("actuator lag", 0.7)]) == "Likely, the servo lags."
    assert as_sure("The servo lags.", [("actuator lag", 0.97)]) == "The servo lags."


def test_the_first_step_of_an_undecided_answer_is_the_flight_that_separates_the_two():
    reasons = (Contribution("fit", 1.0, "fit"), Contribution("prior", -0.8, "prior"))
    found = diagnosis(evidence=evidence((DELAY, 0.55), (LAG, 0.45)), why=reasons)
    (step,) = next_steps(found, ["flight.tlog"], None)
    assert step.text.startswith("To separate transport delay from actuator lag: ")
    assert step.text.endswith(
        "The same number of manoeuvres is expected to raise transport delay to 77 % between these two."
    )
    assert "NOT DECIDED BETWEEN TRANSPORT DELAY AND ACTUATOR LAG" in box(found)


def test_manoeuvres_that_fit_both_alike_promise_no_probability():
    reasons = (Contribution("prior", 0.2, "prior"),)
    (step,) = next_steps(
        diagnosis(evidence=evidence((DELAY, 0.55), (LIFT, 0.45)), why=reasons), ["flight.tlog"], None
    )
    assert step.text == (
        "To separate transport delay from something without a name in the lift: fly the same "
        "number of manoeuvres again, with another time unit and another amplitude."
    )


def test_only_a_decided_answer_is_put_into_the_simulator():
    decided = diagnosis(evidence=evidence((DELAY, 0.61), (LAG, 0.39)))
    assert next_steps(decided, ["flight.tlog"], None)[0].text.startswith("Add to what the file states")


def test_the_longest_title_fits_80_columns():
    lift = Alternative("effect", "nonlinear_pitching_moment", "moment_equation")
    late = Alternative("effect", "accelerometer_skew", "timing")
    assert "…" not in box(diagnosis(evidence=evidence((lift, 0.5), (late, 0.4))))
