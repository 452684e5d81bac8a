"""A number beside its limit never reads as equal to it."""

from math import nan

import numpy as np
import pytest

from advisor.cli.options import parse_mark
from advisor.words.problems import ConfigurationError
from advisor.words.quantities import clock, distinct_texts, maneuvers_said, stretch


@pytest.mark.parametrize(
    ("value", "limit", "digits", "texts"),
    [
        (43.2, 30.0, 0, ("43", "30")),
        (30.4, 30.0, 0, ("30.4", "30.0")),
        (1.86, 1.9, 1, ("1.86", "1.90")),
        (7.96, 8.0, 1, ("7.96", "8.00")),
        (24.9996, 25.0, 0, ("24.9996", "25.0000")),
    ],
)
def test_as_many_digits_are_shown_as_it_takes_to_differ(value, limit, digits, texts):
    assert distinct_texts(value, limit, digits) == texts


def test_numbers_of_any_size_are_told_apart_by_significant_digits():
    assert distinct_texts(3.04e-9, 3.0e-9, 2, "g") == ("3.04e-09", "3e-09")
    assert distinct_texts(8e-9, 3e-9, 2, "g") == ("8e-09", "3e-09")


def test_a_rate_beyond_a_hundred_has_no_exponent():
    assert distinct_texts(134.0, 243.0, 2, "g") == ("130", "240")


def test_the_texts_stand_on_the_side_of_the_limit_on_which_the_numbers_are():
    rng = np.random.default_rng(3)
    for limit in 10.0 ** rng.uniform(-2.0, 3.0, 200):
        value = limit * (1.0 + 10.0 ** rng.uniform(-5.0, 1.0) * rng.choice([-1.0, 1.0]))
        for style, digits in (("f", 0), ("g", 2)):
            shown, beside_it = map(float, distinct_texts(value, limit, digits, style))
            assert (shown > beside_it) == (value > limit)


def test_equal_numbers_are_shown_as_equal():
    assert distinct_texts(25.0, 25.0) == ("25", "25")


@pytest.mark.parametrize(
    ("numbers", "text"),
    [([3], "manoeuvre 3"), ([3, 4], "manoeuvres 3, 4"), ([3, 4, 5], "manoeuvres 3 to 5")],
)
def test_one_manoeuvre_is_said_in_the_singular(numbers, text):
    assert maneuvers_said(numbers) == text


@pytest.mark.parametrize(
    ("seconds", "text"),
    [
        (0.0, "0:00.0"),
        (187.46, "3:07.5"),
        (59.96, "1:00.0"),
        (7384.0, "123:04.0"),
        (-2.5, "-0:02.5"),
        (nan, "–"),
    ],
)
def test_a_time_reads_as_minutes_and_seconds(seconds: float, text: str):
    assert clock(seconds) == text


def test_a_stretch_reads_as_its_two_ends():
    assert stretch(187.5, 199.0) == "3:07.5 to 3:19.0"


@pytest.mark.parametrize("text", ["80.4:93", "1:20.4:1:33", "+80.4:+93", "+1:20.4:+1:33.0"])
def test_a_mark_is_read_as_times_are_written(text: str):
    mark = parse_mark(text)
    assert (mark.start_s, mark.end_s) == pytest.approx((80.4, 93.0))
    assert mark.from_log_start == text.startswith("+")


@pytest.mark.parametrize("text", ["1:80.4:1:93", "1:20:33", "1:2:3:4:5", "a:b:c:d", ":"])
def test_a_mark_that_is_no_stretch_of_time_is_refused_with_an_example(text: str):
    with pytest.raises(ConfigurationError, match=r"1:20\.4:1:33"):
        parse_mark(text)
