"""Vehicle time is written in one way everywhere."""

from math import nan

import pytest

from advisor.cli.options import parse_mark
from advisor.words.problems import ConfigurationError
from advisor.words.vehicle_time import clock, stretch


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
