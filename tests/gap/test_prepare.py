"""The speed to which the derivatives of a diagnosis belong, and the channels that tell."""

from dataclasses import replace

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


def test_an_autopilots_estimate_of_the_angle_of_attack_identifies_no_cause(flown):
    measured = prepare(flown, Aircraft())
    alpha = measured.channels.index("alpha")
    every = list(range(len(measured.channels)))
    assert replace(measured, alpha_is_derived=False).telling == every
    assert replace(measured, alpha_is_derived=True).telling == [c for c in every if c != alpha]


def test_the_air_shows_in_the_angle_of_attack_or_in_the_specific_force(flown):
    measured = prepare(flown, Aircraft())
    for channels, shown in (("alpha", "q"), True), (("a_z", "q"), True), (("q", "theta"), False):
        assert replace(measured, channels=channels).shows_air is shown
