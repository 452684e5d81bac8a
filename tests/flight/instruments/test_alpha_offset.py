"""An offset of the angle of attack that an instrument has is there from the first second."""

import pytest

from advisor.flight.instruments.measured import UNKNOWN, AlphaOffset


@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_an_offset_stays_while_less_than_half_of_it_came_later(sense):
    assert AlphaOffset(rad=0.02, change_rad=sense * 0.009).stays
    assert not AlphaOffset(rad=0.02, change_rad=sense * 0.011).stays


def test_an_unknown_change_speaks_against_no_instrument():
    assert UNKNOWN.stays
