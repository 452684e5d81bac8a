"""The digits of an estimate follow its interval."""

import pytest

from advisor.report.facts.estimates import EstimatedParameter
from advisor.report.result_rows import joint_of


@pytest.mark.parametrize(
    ("value", "half", "prior", "cells"),
    [
        (-51.5637, 7.42, -48.3, ("M_α", "−51.6 ± 7.4", "1.8", "−48.3", "1/s²")),
        (-104.7, 0.083, None, ("M_α", "−104.700 ± 0.083", "1.8", "–", "1/s²")),
    ],
)
def test_a_value_has_the_decimals_of_its_interval(
    value: float, half: float, prior: float | None, cells: tuple[str, ...]
) -> None:
    row = EstimatedParameter(
        name="M_α", source="", unit="1/s²", value=value, half=half, half_if_white=1.8, prior=prior
    )
    assert joint_of("joint", "", [row]).rows == (cells,)
