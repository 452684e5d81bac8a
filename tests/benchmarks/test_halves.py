"""Two halves of one flight: when their answers agree."""

import pytest

from benchmarks.halves import Answer, agree, halves_of

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


def test_of_seven_manoeuvres_the_second_half_has_four():
    first, second = halves_of(list("abcdefg"))
    assert ("".join(first), "".join(second)) == ("abc", "defg")
