"""An autopilot's own angle of attack: late, held and made of its IMU by nature, which is no gap."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.effects import EFFECTS
from advisor.gap.records.floor import prefiltered
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_alpha import is_estimate
from tests.gap.diagnosed import diagnose
from tests.gap.generator import Setup, fly

# One diagnosis serves two tests.
pytestmark = pytest.mark.xdist_group("autopilot alpha")


def estimated(maneuvers, late_s=0.025):
    """Return the manoeuvres with an angle of attack of 10 Hz, late and smooth, from an estimator."""
    found = []
    for m in maneuvers:
        alpha = m.channels["alpha"]
        smooth = np.convolve(np.pad(alpha.y, 2, mode="edge"), np.full(5, 0.2), mode="valid")
        own = replace(
            alpha, t=alpha.t[::5] + late_s, y=smooth[::5], source="XKF1, XKF2", provenance="derived"
        )
        found.append(replace(m, channels={**m.channels, "alpha": own}))
    return found


@pytest.fixture(scope="module")
def alike():
    return diagnose(estimated(fly(Setup(maneuvers=6, seed=71))), Aircraft())


@pytest.mark.study
def test_the_lateness_of_an_autopilots_own_angle_of_attack_is_no_gap(alike):
    assert alike.kinematics.finding == "late"
    assert alike.verdict == "none"
    assert not any(c.present for c in alike.causes)


@pytest.mark.study
def test_what_one_imu_cannot_show_of_itself_is_said_to_be_unseen(alike):
    unseen = {u.effect: u.would_need for u in alike.cannot_see}
    hidden = [name for name, effect in EFFECTS.items() if effect.of_one_imu]
    assert {name: unseen[name] for name in hidden} == dict.fromkeys(hidden, "a vane")


@pytest.mark.parametrize(("share", "of_estimator"), [(slice(None, None, 5), True), (slice(None), False)])
def test_an_angle_of_attack_that_is_renewed_as_slowly_as_arduplanes_is_an_estimate_however_rough(
    share, of_estimator
):
    (flown,) = fly(Setup(maneuvers=1, seed=71))
    alpha = flown.channels["alpha"]
    sent = replace(alpha, t=alpha.t[share], y=alpha.y[share], source="AOA_SSA.AOA", provenance="derived")
    assert is_estimate(replace(flown, channels={**flown.channels, "alpha": sent}), False) == of_estimator


@pytest.mark.study
def test_a_lag_of_the_servo_is_told_beside_it():
    flown = estimated(fly(Setup(maneuvers=6, switches={"lag": 0.08}, seed=71)))
    found = diagnose(flown, Aircraft())
    assert [c.effect for c in found.causes if c.present] == ["actuator_lag"]


def test_a_smooth_estimate_of_the_angle_of_attack_says_nothing_of_the_noise_of_other_channels():
    flights = prepare(estimated(fly(Setup(maneuvers=3, noise=0.005, seed=71))), Aircraft())
    assert flights.alpha_is_smoothed
    assert prefiltered(flights) == {"alpha": True, "q": False, "a_z": False, "theta": False}
    assert all(prefiltered(replace(flights, alpha_is_derived=False)).values())
