"""The air speed is a cause where work was done on the aircraft, not where it was exchanged for height."""

from dataclasses import replace

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.signals.record import Channel
from advisor.gap.candidates.known import variants_for
from advisor.gap.records.airspeed import airspeed_on, measures_speed
from advisor.gap.records.prepare import prepare
from advisor.gap.records.unmeasured_speed import speed_of_the_motion
from advisor.gap.simulator.layout import SPEED
from advisor.oem.airspeed import airspeed
from tests.gap.generator import UAV, Setup, fly
from tests.maneuvers import changed, without

HEIGHTS = (80.0, 90.0, 85.0)


@pytest.mark.parametrize("share", [0.9, 1.1])
def test_a_speed_at_which_nothing_flies_is_none_to_estimator_and_diagnosis_alike(share):
    flown = fly(Setup(maneuvers=1))[0]
    maneuver = changed(flown, "airspeed", y=np.full(len(flown.channels["airspeed"]), share * 4.0))
    assert measures_speed(maneuver) == (share > 1.0)
    assert (airspeed(maneuver.channels) is not None) == (share > 1.0)


def test_a_power_of_the_speed_is_not_looked_for_where_the_speed_hardly_moved():
    flown = prepare(fly(Setup(maneuvers=3, speed_change=0.1, seed=8)), Aircraft())
    still = replace(flown, speed_moves=0.02)
    assert "airspeed_variation" in {variant.effect for variant in variants_for(flown)}
    assert "airspeed_variation" not in {variant.effect for variant in variants_for(still)}


def without_instrument(flown):
    return [without(m, "airspeed") for m in flown]


def test_without_an_air_speed_in_the_log_the_accelerometers_show_how_it_changes():
    flown = fly(Setup(maneuvers=2, seed=51))
    measured = prepare(flown, Aircraft()).flights
    shown = prepare(without_instrument(flown), Aircraft(airspeed_m_s=UAV.speed)).flights
    for one, other in zip(measured, shown, strict=True):
        swing = np.ptp(one.slow[SPEED])
        assert swing > 1.0
        assert np.max(np.abs(one.slow[SPEED] - other.slow[SPEED])) < 0.25 * swing


def test_without_an_air_speed_in_the_log_the_motion_shows_it():
    flown = without_instrument(fly(Setup(maneuvers=6, seed=51)))
    assert speed_of_the_motion(flown) == pytest.approx(UAV.speed, rel=0.02)


def test_without_an_air_speed_in_the_log_the_motion_shows_how_the_manoeuvres_speeds_differ():
    logged = fly(Setup(maneuvers=8, speed_change=0.12, seed=52))
    flown = without_instrument(logged)
    measured = [f.slow[SPEED].mean() for f in prepare(logged, Aircraft()).flights]
    shown = [f.slow[SPEED].mean() for f in prepare(flown, Aircraft(airspeed_m_s=UAV.speed)).flights]
    assert np.array(shown) / np.mean(shown) == pytest.approx(np.array(measured) / np.mean(measured), abs=0.02)


@pytest.mark.parametrize(("amplitude_m_s", "follows"), [(0.4, False), (2.0, True)])
def test_an_air_speed_that_disagrees_with_the_motion_by_more_than_3_percent_is_taken_as_read(
    amplitude_m_s, follows
):
    t = np.arange(0.0, 12.0, 0.05)
    still = {"a_x": 0.0, "a_z": -9.80665, "theta": 0.0, "alpha": 0.0}
    reading = 20.0 + amplitude_m_s * np.sin(2.0 * np.pi * t / 3.0)
    told = {**{name: np.full_like(t, value) for name, value in still.items()}, "airspeed": reading}
    flown = fly(Setup(maneuvers=1))[0]
    channels = {name: Channel(name, t, y, "VFR_HUD.airspeed", "measured") for name, y in told.items()}
    grid = np.arange(0.0, 12.0, 0.005)
    found = airspeed_on(grid, replace(flown, channels=channels), 0.0)
    assert (np.ptp(found) > amplitude_m_s) == follows
