"""Effects whose shape no parabola and no constant has: a kink of the lift, lift that grows by a share."""

import pytest

from advisor.aircraft import Aircraft
from advisor.gap.diagnose import diagnose
from tests.gap.generator import Setup, fly


@pytest.mark.parametrize(("kink_rad", "seed"), [(0.07, 11), (0.10, 12)])
def test_flow_that_separates_within_a_degree_or_two_is_lift_that_curves_and_no_gust(kink_rad, seed):
    found = diagnose(fly(Setup(maneuvers=6, switches={"kink_at": kink_rad}, seed=seed)), Aircraft())
    assert found.verdict == "effect"
    assert found.causes[0].effect == "nonlinear_lift"
    assert found.shrink.percent > 90.0


def test_a_lift_slope_that_grows_near_the_ground_is_the_ground():
    found = diagnose(
        fly(Setup(maneuvers=6, heights_m=(6.0, 9.0, 60.0), switches={"ground": 0.3}, seed=13)), Aircraft()
    )
    assert found.causes[0].effect == "ground_effect"
    assert found.verdict == "effect"


def test_a_manoeuvre_in_which_the_aircraft_departed_is_left_out_and_the_rest_is_judged():
    flown = fly(Setup(maneuvers=6, heights_m=(6.0, 60.0, 60.0), switches={"ground": 1.0}, seed=13))
    assert max(float(abs(m.channels["alpha"].y).max()) for m in flown) > 2.0
    found = diagnose(flown, Aircraft())
    assert len(found.gap.by_maneuver) == 4
