"""Telemetry of the world: each natural number changes the messages that carry the number, and no other."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from benchmarks.sealed.tlog import Timed, packed
from benchmarks.sealed.world import World, changed, draw_world, in_the_world, messages_of
from sim.sealed.cases import SealedCase

QUIET = World(0.0, 1.0, 0.0, 1e-6, 0.0, 0.0, (0.0, 0.0, 0.0), (0.0, 0.0), 40.0)


def flight() -> list[Timed]:
    """Return 4 s of messages, with an air speed that rises by 1 m/s each second."""
    timed: list[Timed] = []
    for k in range(200):
        t = 20.0 + 0.02 * k
        ms, us = round(1e3 * t), round(1e6 * t)
        timed.append((t, mavlink.MAVLink_attitude_message(ms, 0.0, 0.1, 0.0, 0.0, 0.02, 0.0)))
        timed.append((t, mavlink.MAVLink_raw_imu_message(us, 0, 0, -1000, 0, 0, 0, 0, 0, 0)))
        timed.append((t, mavlink.MAVLink_servo_output_raw_message(us, 0, *([1500] * 8))))
        timed.append((t, mavlink.MAVLink_vfr_hud_message(t, 20.0, 0, 40, 600.0, 0.0)))
    return timed


def values(timed: list[Timed], kind: str, field: str) -> np.ndarray:
    return np.array([getattr(m, field) for _, m in timed if m.get_type() == kind], float)


def in_world(**numbers: Any) -> list[Timed]:
    return list(changed(flight(), replace(QUIET, **numbers)))


def test_a_log_is_read_back_as_it_was_packed() -> None:
    again = messages_of(packed(flight()))
    assert [m.get_type() for _, m in again] == [m.get_type() for _, m in flight()]
    assert np.allclose([sent for sent, _ in again], [sent for sent, _ in flight()], atol=1e-5)


def test_a_late_command_has_stamps_ahead_of_its_effect() -> None:
    moved = values(in_world(command_late_s=0.016), "SERVO_OUTPUT_RAW", "time_usec")
    assert np.all(values(flight(), "SERVO_OUTPUT_RAW", "time_usec") - moved == 16_000)


def test_a_late_air_speed_shows_the_value_of_earlier() -> None:
    shown = values(in_world(airspeed_late_s=0.12), "VFR_HUD", "airspeed")
    assert shown[50:] == pytest.approx(values(flight(), "VFR_HUD", "airspeed")[50:] - 0.12, abs=1e-3)


def test_an_air_speed_is_a_staircase_between_two_renewals() -> None:
    shown = values(in_world(airspeed_renewed_s=0.1), "VFR_HUD", "airspeed")
    assert len(np.unique(shown)) == 40


def test_a_pitot_tube_that_reads_low_shows_less_everywhere() -> None:
    assert values(in_world(read_over_true=0.95), "VFR_HUD", "airspeed")[0] == pytest.approx(19.0)


def test_the_bias_of_a_gyro_drifts() -> None:
    rate = values(in_world(gyro_bias_rad_s=0.001, gyro_drift_rad_s2=0.0005), "ATTITUDE", "pitchspeed")
    assert rate[0] == pytest.approx(0.021)
    assert rate[-1] == pytest.approx(0.021 + 0.0005 * 3.98, abs=1e-5)


def test_a_bias_of_the_accelerometer_is_in_the_unit_of_its_message() -> None:
    force = values(in_world(force_bias_m_s2=(0.0, 0.0, 0.2)), "RAW_IMU", "zacc")
    assert np.all(force == round(-1000 + 0.2 * 1e3 / 9.80665))


def test_the_error_of_the_attitude_swings_slowly() -> None:
    pitch = values(in_world(attitude_error_rad=(0.0, 0.005), drift_period_s=4.0), "ATTITUDE", "pitch")
    assert np.max(pitch) == pytest.approx(0.105, abs=1e-4)
    assert np.min(pitch) == pytest.approx(0.095, abs=1e-4)


def test_a_quiet_world_changes_nothing() -> None:
    assert packed(in_world()) == packed(flight())


def test_natural_numbers_stay_within_data_sheets() -> None:
    drawn = [draw_world(np.random.default_rng(seed)) for seed in range(200)]
    assert max(w.command_late_s for w in drawn) <= 0.016
    assert all(0.95 <= w.read_over_true <= 0.97 for w in drawn)
    biases = np.degrees([abs(w.gyro_bias_rad_s) for w in drawn])
    assert 0.05 <= biases.min() < biases.max() <= 0.2


def test_the_aircraft_file_of_the_world_states_the_air_speed_that_is_read() -> None:
    case = SealedCase("0001", {"kind": "none"}, packed(flight()), {"reference_airspeed_m_s": 20.0})
    other = in_the_world(case, 3)
    assert other.aircraft["reference_airspeed_m_s"] == pytest.approx(
        20.0 * other.truth["world"]["read_over_true"], rel=1e-4
    )
    assert in_the_world(case, 3).log == other.log
