"""Half of a 95 % interval is 1.96 standard deviations wherever a report shows one."""

from math import degrees
from types import SimpleNamespace

import pytest

from advisor.oem.coefficients import Coefficient
from advisor.report.facts.estimates import estimated_parameter
from advisor.report.qualities import quality_lines
from advisor.words.digits import with_half
from tests.decision.campaigns import estimate

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
