"""The speed to which the derivatives of a diagnosis belong."""

import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.prepare import prepare
from tests.gap.generator import Setup, fly


@pytest.fixture(scope="module")
def flown():
    return fly(Setup(maneuvers=2))


def test_the_file_states_the_reference_speed(flown):
    assert prepare(flown, Aircraft(reference_airspeed_m_s=15.0)).reference_m_s == 15.0


def test_without_one_it_is_the_mean_of_the_flight(flown):
    mean = sum(maneuver.channels["airspeed"].y.mean() for maneuver in flown) / 2.0
    assert prepare(flown, Aircraft()).reference_m_s == pytest.approx(mean)
