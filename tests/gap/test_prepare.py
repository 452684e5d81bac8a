"""The speed to which the derivatives of a diagnosis belong, and the channels that tell."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import butter, lfilter, sosfiltfilt

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.records.prepare import prepare
from advisor.gap.records.smoothness import is_filtered, is_smoothed
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


def test_a_record_filtered_on_the_ground_is_told_from_noise_and_from_moving_air():
    rng = np.random.default_rng(3)
    noise = rng.standard_normal(2000)
    low_passed = sosfiltfilt(butter(4, 2.0, fs=50.0, output="sos"), noise)
    air = lfilter([1.0], [1.0, -0.97], noise)
    assert is_filtered([low_passed])
    assert not is_filtered([noise])
    assert not is_smoothed([air])
