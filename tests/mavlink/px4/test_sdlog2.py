"""PX4's log before ULog: the container of DataFlash, other records, times by rounds."""

import math
import struct
from pathlib import Path

import numpy as np
import pytest

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Elevator
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log
from tests.heard import hear_log
from tests.mavlink.ardupilot.test_autopilot_logs import G, elevator_us, motion

FORMATS = {
    "TIME": (129, "Q", "StartTime"),
    "ATT": (2, "ffffff", "Roll,Pitch,Yaw,RollRate,PitchRate,YawRate"),
    "IMU": (4, "fffffffff", "AccX,AccY,AccZ,GyroX,GyroY,GyroZ,MagX,MagY,MagZ"),
    "LPOS": (6, "ffffff", "X,Y,Z,VX,VY,VZ"),
    "STAT": (10, "BBB", "MainState,ArmState,FailsafeState"),
    "OUT0": (12, "ffffffff", "Out0,Out1,Out2,Out3,Out4,Out5,Out6,Out7"),
    "AIRS": (13, "ff", "IndSpeed,TrueSpeed"),
}


def record(name: str, *values: float) -> bytes:
    number, form, _ = FORMATS[name]
    return bytes([0xA3, 0x95, number]) + struct.pack("<" + form, *values)


def flight(seconds: float = 30.0, without: str = "") -> bytes:
    log = []
    for name, (number, form, columns) in FORMATS.items():
        length = 3 + struct.calcsize("<" + form)
        body = struct.pack("<BB4s16s64s", number, length, name.encode(), form.encode(), columns.encode())
        log.append(b"\xa3\x95\x80" + body)
    for i in range(round(seconds * 50)):
        us = 1_000_000 + 20_000 * i
        theta, q = motion(us * 1e-6)
        log.append(record("TIME", us))
        log.append(record("ATT", 0.0, theta, 0.0, 0.0, q, 0.0))
        log.append(record("IMU", 0.1, 0.0, -G, 0.0, q, 0.0, 0.0, 0.0, 0.0))
        log.append(record("OUT0", 1500, elevator_us(us * 1e-6), *[900] * 6))
        if i % 5 == 0:
            log.append(record("AIRS", 25.0, 26.0))
            log.append(record("LPOS", 0.0, 0.0, -100.0, 20.0, 0.0, -0.5))
        if i % 50 == 0:
            log.append(record("STAT", 0, 2, 0))
    unwanted = FORMATS[without][0] if without else -1
    return b"".join(one for one in log if one[2] != unwanted)


def heard(tmp_path: Path, content: bytes) -> FlightStream:
    path = tmp_path / "flight.px4log"
    path.write_bytes(content)
    return hear_log(path, Aircraft(elevator=Elevator(output=2))).stream


def test_the_manoeuvre_in_it_is_found(tmp_path: Path) -> None:
    stream = heard(tmp_path, flight())
    assert stream.maneuvers == 1
    assert str(stream.vehicle) == "px4 1/1"
    assert stream.mode == "Manual"
    assert {"elevator", "q", "alpha", "theta", "a_z", "airspeed"} <= stream.channels.keys()


def test_each_record_has_the_time_of_its_round(tmp_path: Path) -> None:
    path = tmp_path / "flight.px4log"
    path.write_bytes(flight())
    (attitude,) = [c for batch in open_log(path, ["ATTITUDE"]) for c in batch]
    t = attitude.fields["time_boot_ms"] / 1000.0
    np.testing.assert_allclose(attitude.fields["pitchspeed"], [motion(s)[1] for s in t], rtol=1e-5)
    np.testing.assert_allclose(attitude.fields["pitch"], [motion(s)[0] for s in t], rtol=1e-5)
    assert math.isclose(t[0], 1.0)


@pytest.mark.parametrize(("without", "name"), [("OUT0", "OUT0"), ("ATT", "ATT")])
def test_what_is_missing_is_told_in_its_own_names(tmp_path: Path, without: str, name: str) -> None:
    (problem,) = heard(tmp_path, flight(without=without)).problems()
    assert f"({name})" in problem.text
    assert "SDLOG_EXT" in problem.fix
    assert "LOG_BITMASK" not in str(problem)
