"""Whether a row of results has numbers to show."""

from dataclasses import replace
from math import nan

import pytest

from advisor.oem.estimate import InstrumentEstimate
from advisor.report.result_rows import ParameterRow, instrument_rows
from advisor.words.quantities import PARAMETERS
from tests.decision.campaigns import estimate


@pytest.mark.parametrize(
    ("value", "half", "known"), [(1.0, 0.1, True), (1.0, nan, False), (nan, 0.1, False), (nan, nan, False)]
)
def test_a_row_is_known_with_both_its_value_and_its_interval(value, half, known):
    row = ParameterRow(PARAMETERS["M_alpha"], value, half, half_if_white=0.1, prior=None)
    assert row.is_known is known


@pytest.mark.parametrize(
    ("with_vane", "name"),
    [
        (True, "vane ahead of the centre of gravity"),
        (False, "α reads like a vane ahead of the centre of gravity"),
    ],
)
def test_an_aircraft_without_a_vane_has_no_vane_arm_among_its_nuisance_parameters(with_vane, name):
    found = replace(estimate(), instruments=(InstrumentEstimate("vane_arm_m", -0.17, 0.05, None),))
    assert [row.name for row in instrument_rows(found, with_vane)] == [name]
