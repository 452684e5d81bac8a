"""Two halves of one flight: when their answers agree."""

import pytest

from advisor.gap.alternative import Alternative, AlternativeEvidence
from benchmarks.halves import Answer, agree, answer_of, halves_of
from tests.gap.test_report_screen import diagnosis

LAG, SURE_LAG = Answer("actuator_lag", 0.5), Answer("actuator_lag", 0.9)
DELAY, NONE = Answer("transport_delay", 0.95), Answer("none", None)


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (SURE_LAG, LAG, True),
        (LAG, DELAY, True),
        (SURE_LAG, DELAY, False),
        (NONE, DELAY, False),
        (NONE, LAG, True),
    ],
)
def test_halves_agree_on_one_answer_or_where_one_is_not_sure(one, other, same):
    assert agree(one, other) is same
    assert agree(other, one) is same


def test_the_probability_of_a_verdict_without_a_cause_is_that_of_its_row():
    rows = (("parameters", 0.5), ("none", 0.45))
    evidence = tuple(AlternativeEvidence(Alternative(name, name), (), p) for name, p in rows)
    assert answer_of(diagnosis(verdict="none", evidence=evidence)) == Answer("none", 0.45)


def test_the_probability_of_a_set_counts_for_its_main_effect():
    delay = Alternative("effect", "transport_delay", "input")
    rows = ((delay, 0.3), (Alternative("effect", "transport_delay", "input", "gust"), 0.4))
    evidence = tuple(AlternativeEvidence(one, (), p) for one, p in rows)
    assert answer_of(diagnosis(evidence=evidence)) == Answer("transport_delay", pytest.approx(0.7))


def test_of_seven_manoeuvres_the_second_half_has_four():
    first, second = halves_of(list("abcdefg"))
    assert ("".join(first), "".join(second)) == ("abc", "defg")
