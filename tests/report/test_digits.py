"""The digits of an estimate follow its interval."""

from dataclasses import replace
from math import degrees
from types import SimpleNamespace

import pytest

from advisor.oem.coefficients import Coefficient
from advisor.oem.notes import value_in_words
from advisor.report.facts.estimates import EstimatedParameter, estimated_parameter
from advisor.report.qualities import quality_lines
from advisor.report.text import joint_of
from advisor.words.quantities import with_half
from tests.decision.campaigns import estimate


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


HALF = 1.96


def test_flying_qualities_and_coefficients_are_shown_with_half_their_interval() -> None:
    found = SimpleNamespace(
        qualities={"natural_frequency": Coefficient(7.5, 0.1)},
        left_out={},
        levels=(),
        airspeed_m_s=25.0,
        true_airspeed_m_s=25.0,
        air=SimpleNamespace(speed_kind="true", sentence="dry air."),
    )
    text = "\n".join(quality_lines(found, {"C_L_alpha": Coefficient(5.0, 1.0)}))  # type: ignore[arg-type]
    assert "7.50 ± 0.20 rad/s" in text
    assert "C_L_alpha 5.0 ± 2.0" in text


def test_a_trim_is_shown_in_degrees_with_half_its_interval() -> None:
    value, half = (float(part) for part in estimated_parameter("M_0", "", estimate(), {}).cell.split(" ± "))
    assert value == pytest.approx(degrees(0.475), abs=0.05)
    assert half == pytest.approx(HALF * degrees(0.00475), abs=0.005)


@pytest.mark.parametrize(
    ("value", "half", "shown"),
    [(-48.31, 2.13, "−48.3 ± 2.1"), (0.012345, 0.00067, "0.01235 ± 0.00067"), (-0.001, 0.2, "0.00 ± 0.20")],
)
def test_a_number_has_two_digits_of_its_interval_and_is_never_minus_zero(value, half, shown):
    assert with_half(value, half) == shown
