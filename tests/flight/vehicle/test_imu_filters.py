"""Known delays of an autopilot's own filters."""

import pytest

from advisor.flight.vehicle.parameters import filter_delay_s

TWENTY_HZ_S = 0.011254
AT_20_HZ = {"INS_GYRO_FILTER": 20.0, "INS_ACCEL_FILTER": 20.0}


@pytest.mark.parametrize("channel", ["q", "a_z"])
def test_arduplane_s_filters_of_20_hz_delay_gyro_and_accelerometer_by_11_ms(channel):
    assert filter_delay_s(channel, "", "ardupilot", AT_20_HZ) == pytest.approx(TWENTY_HZ_S, abs=1e-6)


@pytest.mark.parametrize("channel", ["q", "a_z"])
def test_a_filter_that_no_parameter_states_delays_nothing(channel):
    assert filter_delay_s(channel, "", "ardupilot", {}) == 0.0


def test_a_stated_cut_off_counts_and_zero_switches_the_filter_off():
    stated = {"INS_GYRO_FILTER": 40.0, "INS_ACCEL_FILTER": 0.0}
    assert filter_delay_s("q", "", "ardupilot", stated) == pytest.approx(TWENTY_HZ_S / 2.0, abs=1e-6)
    assert filter_delay_s("a_z", "", "ardupilot", stated) == 0.0


def test_a_notch_delays_the_gyro_only():
    notch = {**AT_20_HZ, "INS_HNTCH_ENABLE": 1.0, "INS_HNTCH_FREQ": 80.0, "INS_HNTCH_BW": 40.0}
    more = filter_delay_s("q", "", "ardupilot", notch) - TWENTY_HZ_S
    assert more == pytest.approx(0.000995, abs=1e-5)
    assert filter_delay_s("a_z", "", "ardupilot", notch) == pytest.approx(TWENTY_HZ_S, abs=1e-6)


def test_px4_s_raw_accelerations_are_not_filtered():
    stated = {"IMU_GYRO_CUTOFF": 40.0, "IMU_ACCEL_CUTOFF": 30.0}
    assert filter_delay_s("a_z", "HIGHRES_IMU.zacc", "px4", stated) == 0.0
    assert filter_delay_s("q", "ATTITUDE.pitchspeed", "px4", stated) == pytest.approx(0.005627, abs=1e-6)


@pytest.mark.parametrize("channel", ["theta", "alpha", "elevator", "airspeed"])
def test_other_channels_pass_no_such_filter(channel):
    assert filter_delay_s(channel, "", "ardupilot", {}) == 0.0
