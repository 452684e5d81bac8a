"""Probabilities and their reasons as sentences."""

import pytest

from advisor.report.facts.reasons import how_sure, in_percent, weighed


def test_four_alternatives_are_named_and_the_others_mentioned():
    four = [("lag", 0.5), ("delay", 0.2), ("gusts", 0.15), ("drift", 0.1)]
    assert how_sure(four) == "Probability: lag 50 %, delay 20 %, gusts 15 %, drift 10 %."
    assert how_sure([*four, ("play", 0.05)]) == how_sure(four)[:-1] + ", others less."


def test_an_alternative_of_zero_per_cent_is_left_out():
    assert how_sure([("lag", 0.996), ("delay", 0.004)]) == "Probability: lag >99 %."
    assert how_sure([("lag", 0.004)]) == ""


def test_the_first_alternative_is_said_with_the_probability_by_the_flight_alone():
    said = how_sure([("lag", 0.99), ("delay", 0.01)], [("delay", 0.15), ("lag", 0.85)])
    assert said == "Probability: lag 99 % (by this flight alone 85 %), delay 1 %."


@pytest.mark.parametrize(
    ("probability", "text"), [(0.9951, ">99 %"), (0.99, "99 %"), (0.0051, "1 %"), (0.0049, "<1 %")]
)
def test_the_ends_of_the_scale_are_bounds(probability, text):
    assert in_percent(probability) == text


@pytest.mark.parametrize(
    ("nats", "told"), [(13.0, "as good as certain"), (-13.0, "as good as excluded"), (10.0, None)]
)
def test_odds_beyond_twelve_nats_are_no_number(nats, told):
    """Twelve nats are odds of 160,000 to 1."""
    said = " ".join(weighed([(nats, "the residual")])[-1])
    assert (told in said) if told else ("as good as" not in said)
