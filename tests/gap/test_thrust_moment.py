"""Whether the throttle of a flight tells the moment of thrust."""

from types import SimpleNamespace

import numpy as np
import pytest

from advisor.gap.effects.thrust_moment import EFFECT
from advisor.gap.simulator.layout import THROTTLE


@pytest.mark.parametrize(("moved", "is_tried"), [(0.01, False), (0.03, True)])
def test_a_moment_of_thrust_is_tried_where_the_throttle_moves_by_two_percent(moved, is_tried):
    flight = SimpleNamespace(slow={THROTTLE: np.linspace(0.5, 0.5 + moved, 20)})
    assert bool(EFFECT.variants(SimpleNamespace(flights=[flight]))) == is_tried
