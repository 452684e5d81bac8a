"""DataFlash records of every year: what was named, stamped or kept otherwise reads as today's."""

from pathlib import Path

import numpy as np
import pytest

from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.ardupilot.body_rates import gyro_delay_s
from advisor.mavlink.logs.logs import open_log
from tests.heard import hear_log
from tests.mavlink.ardupilot.test_autopilot_logs import (
    FIRST_STEP_S,
    dataflash_flight,
    elevator_us,
    finite,
    motion,
)
from tests.mavlink.dataflash_writer import rewritten


def messages(tmp_path: Path, content: bytes) -> dict[str, Columns]:
    path = tmp_path / "flight.bin"
    path.write_bytes(content)
    return {c.name: c for batch in open_log(path) for c in batch}


def said(read: dict[str, Columns]) -> list[str]:
    texts = read["STATUSTEXT"].fields["text"].tolist()
    return [text.decode().removeprefix("Log reader: ") for text in texts if text.startswith(b"Log reader")]


def found(tmp_path: Path, content: bytes) -> FlightStream:
    path = tmp_path / "flight.bin"
    path.write_bytes(content)
    return hear_log(path).stream


def test_records_of_2014_read_as_todays(tmp_path: Path) -> None:
    renamed = {
        "RCOU": {f"C{n}": f"Ch{n}" for n in range(1, 15)},
        "RCIN": {f"C{n}": f"Chan{n}" for n in range(1, 15)},
        "CTUN": {"ThO": "ThrOut"},
        "GPS": {"GWk": "Week"},
    }
    today, old = dataflash_flight(30.0), rewritten(dataflash_flight(30.0), renamed, milliseconds=True)
    read, expected = messages(tmp_path, old), messages(tmp_path, today)
    assert read.keys() == expected.keys()
    for name in ("ATTITUDE", "SERVO_OUTPUT_RAW", "HIGHRES_IMU", "VFR_HUD"):
        for field, values in expected[name].fields.items():
            if not field.startswith("time"):
                np.testing.assert_array_equal(read[name].fields[field], values, err_msg=f"{name}.{field}")
    assert found(tmp_path, old).maneuvers == 1


def test_records_that_state_no_time_have_that_of_the_record_before_them(tmp_path: Path) -> None:
    old = rewritten(dataflash_flight(30.0), without={"PARM": "TimeUS", "MSG": "TimeUS", "MODE": "TimeUS"})
    stream = found(tmp_path, old)
    assert stream.maneuvers == 1
    assert stream.mode == "MANUAL"


def test_the_outputs_of_firmware_before_servo_functions_are_known_by_their_sticks(tmp_path: Path) -> None:
    parameters = {"SERVO2_FUNCTION": "SYS_NUM_RESETS", "SERVO2_TRIM": "RC2_TRIM"}
    content = dataflash_flight(30.0)
    for today, old in parameters.items():
        content = content.replace(today.encode().ljust(16, b"\0"), old.encode().ljust(16, b"\0"))
    stream = found(tmp_path, content)
    assert stream.maneuvers == 1
    assert "output 2 " in stream.elevator_notes[0]


def test_stamps_that_count_from_1970_become_seconds_of_the_log(tmp_path: Path) -> None:
    epoch_us = 1_770_000_000_000_000
    today, late = dataflash_flight(30.0), rewritten(dataflash_flight(30.0), later_us=epoch_us)
    stream = found(tmp_path, late)
    assert stream.maneuvers == 1
    assert stream.boot == 0
    assert stream.duration_s == pytest.approx(found(tmp_path, today).duration_s)
    read = messages(tmp_path, late)
    assert "1970" in said(read)[0]
    assert read["ATTITUDE"].arrival_s[0] == pytest.approx(epoch_us * 1e-6 + 1.0, abs=0.1)


def test_a_second_sensor_with_a_record_of_its_own_stands_in_for_a_dead_first(tmp_path: Path) -> None:
    read = messages(tmp_path, rewritten(dataflash_flight(30.0), good_imu_apart=True))
    np.testing.assert_allclose(read["HIGHRES_IMU"].fields["xacc"], 0.1, rtol=1e-6)
    assert len(read["HIGHRES_IMU"]) == 1500
    assert said(read) == ["Angular rates and specific force: sensor 1 flew"]


def test_a_sensor_that_fails_in_flight_is_not_used_from_then_on_and_it_is_said(tmp_path: Path) -> None:
    read = messages(tmp_path, rewritten(dataflash_flight(30.0), unhealthy={"IMU": (21.0, 24.0)}))
    t = read["HIGHRES_IMU"].fields["time_usec"] * 1e-6
    assert not np.any((t > 21.0) & (t < 24.0))
    assert np.count_nonzero(t > 24.0) == pytest.approx(350, abs=2)
    assert "no sensor was healthy from 0:21.0 to 0:24.0" in said(read)[0]


def test_the_autopilots_own_air_speed_stands_in_for_a_failed_tube(tmp_path: Path) -> None:
    read = messages(tmp_path, rewritten(dataflash_flight(30.0), unhealthy={"ARSP": (21.0, 24.0)}))
    hud = read["VFR_HUD"]
    measured = np.isfinite(hud.fields["airspeed"])
    t, speed = hud.fields["time_usec"][measured] * 1e-6, hud.fields["airspeed"][measured]
    assert set(speed[(t > 21.2) & (t < 23.8)].tolist()) == {24.5}
    assert set(speed[(t < 20.5) | (t > 24.5)].tolist()) == {25.0}
    assert any("As of the autopilot replaces the sensor" in sentence for sentence in said(read))


def pid(t: float) -> dict[str, float]:
    return {"Act": np.degrees(motion(t)[1])}


RATES = {
    "GYR": ("QBQfff", "TimeUS,I,SampleUS,GyrX,GyrY,GyrZ", lambda t: {"GyrY": motion(t)[1]}),
    "PIDP": ("Qffffff", "TimeUS,Tar,Act,Err,P,I,D", pid),
    "RATE": ("Qffffff", "TimeUS,RDes,R,PDes,P,YDes,Y", lambda t: {"P": np.degrees(motion(t)[1])}),
}


@pytest.mark.parametrize("record", [*RATES, "ATT"])
def test_without_imu_the_pitch_rate_comes_from_another_record_and_it_is_said(tmp_path, record):
    added = {name: RATES[name] for name in {record} & RATES.keys()}
    content = rewritten(dataflash_flight(40.0), drop={"IMU"}, add=added)
    read = messages(tmp_path, content)
    rates = np.isfinite(read["ATTITUDE"].fields["pitchspeed"])
    t = read["ATTITUDE"].fields["time_boot_ms"][rates] / 1000.0
    delay_s = gyro_delay_s(None) if record == "ATT" else 0.0
    truth = np.array([motion(s - delay_s)[1] for s in t])
    # The angles of ATT are whole hundredths of a degree and 0.6 ms late.
    np.testing.assert_allclose(read["ATTITUDE"].fields["pitchspeed"][rates], truth, atol=2e-2)
    assert f"{record}" in said(read)[0]
    assert "no IMU records" in said(read)[0]
    assert found(tmp_path, content).maneuvers == 1


def test_a_controller_that_does_not_run_gives_no_pitch_rate(tmp_path: Path) -> None:
    standing = ("Qffffff", "TimeUS,Tar,Act,Err,P,I,D", lambda t: {"Act": min(t, 15.0)})
    read = messages(tmp_path, rewritten(dataflash_flight(30.0), drop={"IMU"}, add={"PIDP": standing}))
    assert "angles of ATT at 25 Hz" in said(read)[0]


def test_raw_gyro_records_become_means_of_five_milliseconds(tmp_path: Path) -> None:
    content = rewritten(dataflash_flight(2.0), drop={"IMU"}, add={"GYR": RATES["GYR"]}, per_att=40)
    attitude = messages(tmp_path, content)["ATTITUDE"]
    rates = finite(attitude, "pitchspeed")
    assert len(rates) == pytest.approx(2.0 * 200, abs=5)


def test_angles_that_come_too_slowly_give_no_rate(tmp_path: Path) -> None:
    stream = found(tmp_path, rewritten(dataflash_flight(30.0), drop={"IMU"}, every={"ATT": 3}))
    assert "q" not in stream.channels
    (problem,) = stream.problems()
    assert "pitch rate" in problem.text
    assert "IMU by bit 7" in problem.fix
    assert elevator_us(FIRST_STEP_S) != 1500
