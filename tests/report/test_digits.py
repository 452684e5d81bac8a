"""The digits of an estimate follow its interval."""

from dataclasses import replace

import pytest

from advisor.oem.findings import value_in_words
from advisor.report.facts.estimates import EstimatedParameter
from advisor.report.result_rows import joint_of


@pytest.mark.parametrize(
    ("value", "half", "prior", "cells"),
    [
        (-51.5637, 7.42, -48.3, ("M_α", "−51.6 ± 7.4", "1.8", "−48.3", "1/s²")),
        (-104.7, 0.083, None, ("M_α", "−104.700 ± 0.083", "1.8", "1/s²")),
    ],
)
def test_a_value_has_the_decimals_of_its_interval(value, half, prior, cells):
    row = EstimatedParameter(
        name="M_α", source="", unit="1/s²", value=value, half=half, half_if_white=1.8, prior=prior
    )
    assert joint_of("joint", "", [row]).rows == (cells,)


def test_without_a_model_in_the_file_no_column_names_a_simulator() -> None:
    row = EstimatedParameter(name="M_α", source="", unit="1/s²", value=-51.6, half=7.4, half_if_white=1.8)
    assert "simulator" not in joint_of("joint", "", [row]).head
    assert "simulator" in joint_of("joint", "", [replace(row, prior=-48.3)]).head


def test_a_held_parameter_has_its_value_and_no_interval() -> None:
    row = EstimatedParameter(
        name="M_q", source="", unit="1/s", value=-2.0, half=0.0, half_if_white=0.0, held=True
    )
    assert joint_of("joint", "", [row]).rows == (("M_q", "−2.000, held", "–", "1/s"),)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("vane_arm_m", -0.18, "alpha reads like a vane 0.18 ± 0.10 m behind the centre of gravity"),
        ("command_delay_s", -0.008, "the command acts 8 ± 98 ms before its stamps"),
        ("alpha_delay_s", 0.02, "alpha is 20 ± 98 ms late relative to the motion"),
    ],
)
def test_a_place_or_a_delay_is_said_by_its_side_and_not_by_its_sign(name, value, said):
    assert value_in_words(name, value, 0.05) == said
