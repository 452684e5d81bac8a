"""Where the search begins: a channel late by a radian of the short period leads no regression astray."""

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.fitting.regression import regressions
from advisor.gap.records.prepare import prepare
from tests.gap.generator import Setup, fly


def test_channels_that_belong_together_need_one_regression():
    (found,) = regressions(prepare(fly(Setup(maneuvers=3, seed=72)), Aircraft()))
    assert found[3] == pytest.approx(-37.4, rel=0.2)
    assert found[5] == pytest.approx(-53.0, rel=0.2)


@pytest.mark.parametrize("late", [{"q": -0.14}, {"q": 0.12}, {"alpha": 0.14}, {"alpha": -0.12}])
def test_with_one_channel_shifted_the_regression_has_the_right_signs_again(late):
    flights = prepare(fly(Setup(maneuvers=3, skew=late, seed=71)), Aircraft())
    plain, shifted = regressions(flights)
    assert np.all(shifted[[0, 3, 5]] < 0.0)
    assert shifted[3] == pytest.approx(-37.4, rel=0.4)
    assert abs(plain[3] + 37.4) > abs(shifted[3] + 37.4)
