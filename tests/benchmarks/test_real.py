"""A figure of a real record holds by its tolerance or its interval, if that interval says something."""

import pytest

from benchmarks.lateral import held
from benchmarks.real import Row, _figures


def judged(value: float, half: float, known: float = -0.6, absolute: float = 0.15) -> tuple[str, bool]:
    model = {"M_alpha": {"value": value, "std": half / 1.96}, "reference_airspeed_m_s": 20.0}
    record = {"figures": {"M_alpha": {"value": known, "absolute": absolute}}}
    ((_, got, holds),) = _figures(record, {"model": model})
    return got, holds


@pytest.mark.parametrize(
    ("value", "half", "holds"),
    [
        (-0.65, 0.1, True),
        (-0.9, 0.35, True),
        (-0.9, 0.2, False),
        (-0.335, 0.66, False),
        (-0.6, 0.61, False),
        (-0.516, 0.59, False),
        (-0.6, 0.59, True),
    ],
)
def test_a_figure_holds_within_its_tolerance_or_its_interval_and_only_with_a_sign(value, half, holds):
    assert judged(value, half)[1] is holds


def test_a_figure_within_its_tolerance_and_outside_its_interval_says_so():
    assert judged(-0.65, 0.02)[0] == "M_alpha -0.65 ± 0.02 (published value outside)"
    assert judged(-0.65, 0.1)[0] == "M_alpha -0.65 ± 0.1"


def test_a_table_says_yes_only_where_the_intervals_hold_the_known_values():
    inside, outside = (Row("a", "", "", judged(-0.65, half)[0], True) for half in (0.1, 0.02))
    assert (inside.word, outside.word) == ("yes", "by tolerance")
    assert [held(0.05, half, 0.06) for half in (0.051, 0.049)] == ["yes", "by tolerance"]
    assert held(-0.061, 0.049, 0.06) == "NO"
