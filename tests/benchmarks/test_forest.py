"""The forest plot of real records."""

from dataclasses import replace

import pytest

from benchmarks.pages.forest import compared, forest
from benchmarks.real import Row

TURBOPROP = Row(
    "t.tlog",
    "twin turboprop, one hand-flown multistep",
    "1 found; M_alpha -10.0 ± 0.5; C_m_alpha -1.3 outside the interval",
    "1 found; M_alpha -9.0 ± 0.2; outside",
    True,
)


def test_an_estimate_stands_relative_to_its_published_value() -> None:
    (row,) = compared([TURBOPROP])
    assert row.label == "t, twin turboprop: M_α"
    assert (row.value, row.half, row.published_half) == pytest.approx((0.9, 0.02, 0.05))


def test_the_plot_has_a_bar_of_each_kind_for_each_quantity() -> None:
    svg = forest([TURBOPROP])
    assert svg.startswith("<svg ")
    assert svg.count("<circle") == 1
    assert svg.count('stroke="#0b5394"') == svg.count('stroke="#9a9a9a"') == 1


def test_a_value_beyond_the_axis_is_an_arrow() -> None:
    far = replace(TURBOPROP, got="1 found; M_alpha -90.0 ± 0.2")
    assert forest([far]).count("<polygon") == 1
    assert "<circle" not in forest([far])
