"""What else a PX4 log tells: rates, modes, dropouts, appended data, changed parameters."""

import io
import struct
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft, Elevator
from advisor.flight.maneuvers.maneuver import ManeuverFlown
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.px4.ulog import WholeFile
from advisor.words.problems import UnusableInputError
from tests.mavlink.px4_logs import G, PX4Log, every, flight, flown, message, parameter, pitch, pulses, stick

ELEVATOR = Elevator(output=2, calibration=((1000.0, 25.0), (2000.0, -25.0)))


def log(rate_hz: float = 25.0, **options) -> PX4Log:
    t = every(rate_hz)
    return flight(**options).topic("actuator_outputs", t, output=pulses(t, {2: 1500.0 + 500.0 * stick(t)}))


def channels(path: Path):
    return flown(path, Aircraft(elevator=ELEVATOR))[0].channels


def test_slow_angular_rates_give_way_to_a_faster_gyro(tmp_path: Path) -> None:
    slow = every(10.0)
    zero = np.zeros(len(slow))
    rates = log().topic("vehicle_angular_velocity", slow, xyz=np.column_stack([zero, pitch(slow)[1], zero]))
    assert channels(rates.write(tmp_path))["q"].rate_hz == pytest.approx(50.0, rel=0.01)


def test_filtered_rates_that_are_fast_enough_are_preferred_to_a_faster_gyro(tmp_path: Path) -> None:
    fast = every(200.0)
    zero = np.zeros(len(fast))
    raw = np.column_stack([zero, pitch(fast)[1], zero])
    gyro = log().topic("sensor_combined", fast, gyro_rad=raw, accelerometer_m_s2=raw - [0.0, 0.0, G])
    found = channels(gyro.write(tmp_path))
    assert found["q"].rate_hz == pytest.approx(50.0, rel=0.01)
    assert found["a_z"].rate_hz == pytest.approx(200.0, rel=0.01)


def test_the_filtered_acceleration_stands_in_for_the_raw_sensor(tmp_path: Path) -> None:
    t = every(20.0)
    force = np.tile([0.0, 0.0, -G], (len(t), 1))
    filtered = log().without("sensor_combined").topic("vehicle_acceleration", t, xyz=force)
    assert channels(filtered.write(tmp_path))["a_z"].rate_hz == pytest.approx(20.0, rel=0.01)


def former(**parameters: float) -> PX4Log:
    """A log of 2018: the rates in vehicle_attitude, the specific force in sensor_accel."""
    t = every(50.0)
    theta, q = pitch(t)
    zero = np.zeros(len(t))
    half = theta / 2
    attitude = np.column_stack([np.cos(half), zero, np.sin(half), zero])
    without = log(**parameters).without("sensor_combined", "vehicle_angular_velocity")
    without.topic("vehicle_attitude", t, q=attitude, rollspeed=0.0, pitchspeed=q, yawspeed=0.0)
    return without.topic("sensor_accel", t, x=0.0, y=0.0, z=-G)


def test_rates_and_force_under_their_former_names_are_read(tmp_path: Path) -> None:
    stream, (one,), _ = flown(former().write(tmp_path), Aircraft(elevator=ELEVATOR))
    q = one.maneuver.channels["q"]
    assert q.y == pytest.approx(pitch(q.t)[1], abs=1e-6)
    assert stream.channels["a_z"].rate_hz == pytest.approx(50.0, rel=0.01)


def test_a_raw_sensor_of_a_turned_board_is_no_specific_force_of_the_body(tmp_path: Path) -> None:
    assert "a_z" not in channels(former(SENS_BOARD_ROT=4).write(tmp_path))


@pytest.mark.parametrize(
    ("nav_state", "mode"),
    [(0, "Manual"), (2, "Position"), (3, "Mission"), (4, "Hold"), (5, "Return"), (10, "Acro"),
     (15, "Stabilized"), (17, "Takeoff"), (18, "Land"), (21, "Orbit"), (23, "Auto")],
)  # fmt: skip
def test_modes_bear_the_names_that_px4s_users_know(tmp_path: Path, nav_state: int, mode: str) -> None:
    assert flown(log(nav_state=nav_state).write(tmp_path))[0].mode == mode


def test_a_vtol_in_hover_flies_no_test_input(tmp_path: Path) -> None:
    hovering = log()
    state = {"nav_state": np.int8(0), "vehicle_type": np.int8(1), "is_vtol": np.int8(1)}
    hovering.topic("vehicle_status", every(2.0), **state)
    stream, maneuvers, _ = flown(hovering.write(tmp_path), Aircraft(elevator=ELEVATOR))
    assert not maneuvers
    assert stream.mode == "Manual, hovering"
    state |= {"vehicle_type": np.int8(2)}
    assert flown(
        hovering.topic("vehicle_status", every(2.0), **state).write(tmp_path), Aircraft(elevator=ELEVATOR)
    )[1]


def test_default_logging_at_10_hz_is_estimated_or_told_how_to_log_faster(tmp_path: Path) -> None:
    stream, maneuvers, _ = flown(log(10.0).write(tmp_path), Aircraft(elevator=ELEVATOR))
    assert len(maneuvers) == 1
    slow, _, _ = flown(log(5.0).write(tmp_path, "slow.ulg"), Aircraft(elevator=ELEVATOR))
    (problem,) = [one for one in slow.problems() if one.code == "rate"]
    assert problem.text.startswith("actuator_outputs arrives at 5.0 Hz")
    assert problem.fix == "Set bit 4 of SDLOG_PROFILE (high rate, 16)."
    assert not [one for one in stream.problems() if one.code == "rate"]


def test_dropouts_of_the_logger_are_said(tmp_path: Path) -> None:
    broken = log()
    broken.extra = message("O", struct.pack("<H", 120)) + message("O", struct.pack("<H", 350))
    _, _, said = flown(broken.write(tmp_path), Aircraft(elevator=ELEVATOR))
    assert any("Logging dropped out 2 times, for 0.35 s at the longest" in text for text in said)


def test_a_parameter_that_changes_in_flight_is_said(tmp_path: Path) -> None:
    wired = {"CA_SV_CS0_TYPE": 3, "CA_SV_CS0_TRQ_P": 1.0, "PWM_MAIN_FUNC2": 201, "PWM_MAIN_MIN2": 1000}
    changed = log(**wired)
    changed.extra = parameter("PWM_MAIN_MIN2", 1200)
    stream, maneuvers, said = flown(changed.write(tmp_path))
    assert len(maneuvers) == 1
    assert stream.elevator.parts[0].scale.low_us == 1000.0
    assert any("PWM_MAIN_MIN2 changed from 1000 to 1200" in text for text in said)


def test_a_log_with_a_broken_value_of_a_parameter_is_read(tmp_path: Path) -> None:
    assert flown(log(CA_SV_CS0_TYPE=float("nan")).write(tmp_path), Aircraft(elevator=ELEVATOR))[1]


def test_a_log_is_read_message_by_message_as_in_one_batch(tmp_path: Path) -> None:
    from advisor.flight.stream.stream import FlightStream
    from advisor.flight.vehicle.pieces import rows_between

    columns = [c for batch in open_log(log().write(tmp_path)) for c in batch]
    past = max(int(c.order[-1]) for c in columns) + 1
    whole, parts = (FlightStream(Aircraft(elevator=ELEVATOR)) for _ in range(2))
    (one,) = [e for e in [*whole.feed(columns), *whole.finish()] if isinstance(e, ManeuverFlown)]
    events = [e for at in range(0, past, 97) for e in parts.feed(rows_between(columns, at, at + 97))]
    (other,) = [e for e in [*events, *parts.finish()] if isinstance(e, ManeuverFlown)]
    assert one.maneuver.span == other.maneuver.span
    for name, channel in one.maneuver.channels.items():
        np.testing.assert_array_equal(channel.t, other.maneuver.channels[name].t)
        np.testing.assert_array_equal(channel.y, other.maneuver.channels[name].y)


def test_an_encrypted_log_is_told_how_to_decrypt(tmp_path: Path) -> None:
    path = tmp_path / "flight.ulge"
    path.write_bytes(b"ULogEnc\x01" + bytes(500))
    with pytest.raises(UnusableInputError, match=r"encrypted.*Tools/decrypt_ulog\.py"):
        list(open_log(path))


def test_a_read_beyond_the_end_of_a_log_fails_so_that_pyulog_cannot_step_back_for_ever() -> None:
    file = WholeFile(io.BytesIO(b"abcd"))
    assert file.read(3) == b"abc"
    with pytest.raises(struct.error):
        file.read(3)
    assert file.read(3) == b""
