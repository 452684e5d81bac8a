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
    none = evidence[1].alternative
    assert answer_of(diagnosis(verdict="none", answer=none, evidence=evidence)) == Answer("none", 0.45)


def test_the_blocks_of_the_unknown_count_together():
    blocks = [Alternative("unknown", "unknown", block) for block in ("input", "force_equation")]
    evidence = tuple(AlternativeEvidence(one, (), p) for one, p in zip(blocks, (0.3, 0.4), strict=True))
    found = answer_of(diagnosis(verdict="unknown", answer=blocks[1], evidence=evidence))
    assert found == Answer("unknown", pytest.approx(0.7))


def test_a_single_manoeuvre_states_no_probability():
    assert answer_of(diagnosis(verdict="unknown", answer=None)) == Answer("unknown", None)


def test_of_seven_manoeuvres_the_second_half_has_four():
    first, second = halves_of(list("abcdefg"))
    assert ("".join(first), "".join(second)) == ("abc", "defg")
