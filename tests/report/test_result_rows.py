"""Whether a row of results has numbers to show."""

from math import nan

import pytest

from advisor.report.result_rows import ParameterRow
from advisor.words.quantities import PARAMETERS


@pytest.mark.parametrize(
    ("value", "half", "known"), [(1.0, 0.1, True), (1.0, nan, False), (nan, 0.1, False), (nan, nan, False)]
)
def test_a_row_is_known_with_both_its_value_and_its_interval(value, half, known):
    row = ParameterRow(PARAMETERS["M_alpha"], value, half, half_if_white=0.1, prior=None)
    assert row.is_known is known
