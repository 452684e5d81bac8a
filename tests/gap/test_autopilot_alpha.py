"""An autopilot's own angle of attack: late, held and made of its IMU by nature, which is no gap."""

from dataclasses import replace

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.floor import prefiltered
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_alpha import is_estimate
from tests.gap.generator import Setup, fly
from tests.gap.studied_flights import estimated
from tests.maneuvers import changed


@pytest.mark.parametrize(("share", "of_estimator"), [(slice(None, None, 5), True), (slice(None), False)])
def test_an_angle_of_attack_that_is_renewed_as_slowly_as_arduplanes_is_an_estimate_however_rough(
    share, of_estimator
):
    (flown,) = fly(Setup(maneuvers=1, seed=71))
    alpha = flown.channels["alpha"]
    sent = {"t": alpha.t[share], "y": alpha.y[share], "source": "AOA_SSA.AOA", "provenance": "derived"}
    assert is_estimate(changed(flown, "alpha", **sent), False) == of_estimator


def test_a_smooth_estimate_of_the_angle_of_attack_says_nothing_of_the_noise_of_other_channels():
    flights = prepare(estimated(fly(Setup(maneuvers=3, noise=0.005, seed=71))), Aircraft())
    assert flights.alpha_is_smoothed
    assert prefiltered(flights) == {"alpha": True, "q": False, "a_z": False, "theta": False}
    assert all(prefiltered(replace(flights, alpha_is_derived=False)).values())
