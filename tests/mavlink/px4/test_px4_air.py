"""Which air speed of a PX4 log counts, and at which times the angle of attack is made of it."""

from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.signals.derived_alpha import DERIVED_ALPHA
from tests.mavlink.px4_logs import PX4Log, every, flight, flown, pitch, pulses, stick

ELEVATOR = Elevator(output=2, calibration=((1000.0, 25.0), (2000.0, -25.0)))


def log(**validated) -> PX4Log:
    """A flight with an air speed sensor at 25 Hz that reads 25 m/s, and with a validated air speed."""
    found = flight()
    t = every(25.0)
    found.topic("actuator_outputs", t, output=pulses(t, {2: 1500.0 + 500.0 * stick(t)}))
    rate_hz = validated.pop("rate_hz", 1.0)
    if validated:
        found.topic("airspeed_validated", every(rate_hz), **validated)
    return found


def airspeed(path: Path):
    """The channel over the manoeuvre, and what was said."""
    _, (one,), said = flown(path, Aircraft(elevator=ELEVATOR))
    return one.maneuver.channels["airspeed"], " ".join(said)


def test_the_sensor_counts_where_the_validated_air_speed_is_slower(tmp_path: Path) -> None:
    speed, _ = airspeed(log(calibrated_airspeed_m_s=25.0, airspeed_source=np.int8(1)).write(tmp_path))
    assert speed.rate_hz == pytest.approx(25.0)


def test_the_validated_air_speed_counts_where_it_is_fast(tmp_path: Path) -> None:
    fast = log(calibrated_airspeed_m_s=26.0, airspeed_source=np.int8(1), rate_hz=50.0)
    speed, _ = airspeed(fast.write(tmp_path))
    assert speed.rate_hz == pytest.approx(50.0)
    assert set(speed.y.tolist()) == {26.0}


def test_a_sensor_is_scaled_as_the_validated_air_speed_has_found(tmp_path: Path) -> None:
    scaled = log(
        calibrated_airspeed_m_s=27.5, indicated_airspeed_m_s=25.0, selected_airspeed_index=np.int8(1)
    )
    speed, _ = airspeed(scaled.write(tmp_path))
    assert speed.y == pytest.approx(27.5)


def test_the_sensor_that_the_autopilot_has_selected_counts(tmp_path: Path) -> None:
    two = log(calibrated_airspeed_m_s=24.0, airspeed_source=np.int8(2))
    two.topic("airspeed", every(25.0), 1, indicated_airspeed_m_s=24.0)
    speed, _ = airspeed(two.write(tmp_path))
    assert set(speed.y.tolist()) == {24.0}
    assert speed.rate_hz == pytest.approx(25.0)


@pytest.mark.parametrize("source", ["airspeed_source", "selected_airspeed_index"])
def test_ground_speed_minus_wind_is_no_measurement_and_said_where_nothing_else_is_there(tmp_path, source):
    estimated = log(calibrated_airspeed_m_s=23.0, rate_hz=5.0, **{source: np.int8(0)})
    speed, said = airspeed(estimated.write(tmp_path))
    assert set(speed.y.tolist()) == {23.0}
    assert "no sensor measured it" in said


def test_a_sensor_that_the_autopilot_calls_invalid_is_used_only_for_want_of_another_and_said(tmp_path):
    refused = log(calibrated_airspeed_m_s=np.nan, airspeed_source=np.int8(-1))
    speed, said = airspeed(refused.write(tmp_path))
    assert speed.y == pytest.approx(25.0)
    assert "calls its sensor invalid" in said


def test_a_measured_air_speed_needs_no_remark(tmp_path: Path) -> None:
    assert "Air speed" not in airspeed(log(calibrated_airspeed_m_s=25.0).write(tmp_path))[1]


def climbing(attitude_late_s: float) -> PX4Log:
    """A flight whose path angle moves, its attitude stamped so much later than the air data."""
    found = log()
    t = every(50.0, attitude_late_s)
    theta, _ = pitch(t)
    half, zero = theta / 2, np.zeros(len(t))
    found.topic("vehicle_attitude", t, q=np.column_stack([np.cos(half), zero, np.sin(half), zero]))
    slow = every(25.0)
    path = pitch(slow)[0] - 0.04
    return found.topic("vehicle_local_position", slow, z=-100.0, vz=-25.0 * np.sin(path))


@pytest.mark.parametrize("late_s", [-3e-6, 3e-6, 0.007, 0.013])
def test_the_derived_angle_of_attack_is_made_of_values_at_one_time(tmp_path: Path, late_s: float) -> None:
    _, (one,), _ = flown(climbing(late_s).write(tmp_path), Aircraft(elevator=ELEVATOR))
    alpha = one.maneuver.channels["alpha"]
    assert alpha.source == DERIVED_ALPHA
    # A chord of 20 ms leaves the curve by h²/8 of its second derivative.
    assert np.max(np.abs(alpha.y - 0.04)) < 0.02**2 / 8 * 2.1 + 2e-4


def test_the_order_of_stamps_decides_nothing(tmp_path: Path) -> None:
    early, late = (
        flown(climbing(late_s).write(tmp_path, f"{late_s}.ulg"), Aircraft(elevator=ELEVATOR))[1][0].maneuver
        for late_s in (-3e-6, 3e-6)
    )
    a, b = early.channels["alpha"], late.channels["alpha"]
    np.testing.assert_array_equal(a.t, b.t)
    np.testing.assert_allclose(a.y, b.y, atol=1e-4)


def test_climb_rate_and_throttle_keep_the_stamps_of_their_own_topics(tmp_path: Path) -> None:
    own = log().topic("vehicle_thrust_setpoint", every(10.0, 0.003), xyz=np.full((400, 3), 0.5))
    own.topic("vehicle_local_position", every(20.0, 0.011), z=-100.0, vz=-0.5)
    _, (one,), _ = flown(own.write(tmp_path), Aircraft(elevator=ELEVATOR))
    channels = one.maneuver.channels
    assert np.round(channels["throttle"].t * 1e3 % 100).tolist()[0] == 3
    assert np.round(channels["climb_rate"].t * 1e3 % 50).tolist()[0] == 11
    assert channels["throttle"].y == pytest.approx(0.5)


def test_a_log_without_a_throttle_has_none(tmp_path: Path) -> None:
    assert "throttle" not in flown(log().write(tmp_path), Aircraft(elevator=ELEVATOR))[0].channels


def test_a_position_whose_climb_rate_is_invalid_does_not_count(tmp_path: Path) -> None:
    invalid = log().topic("vehicle_local_position", every(25.0), z=-100.0, vz=-9.0, v_z_valid=np.int8(0))
    assert "climb_rate" not in flown(invalid.write(tmp_path), Aircraft(elevator=ELEVATOR))[0].channels
