"""The autopilots' own logs: ArduPilot's .bin against pymavlink, PX4's .ulg by hand, both as flights."""

import contextlib
import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pymavlink import DFReader

from advisor.aircraft.aircraft import Aircraft, Elevator, Markers
from advisor.flight.maneuvers.maneuver import ManeuverFlown
from advisor.flight.signals.messages import Columns
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.logs.logs import open_log
from advisor.mavlink.records.stretches import read_stretches
from advisor.words.problems import UnusableInputError
from tests.heard import hear_log
from tests.mavlink.autopilot_logs import (
    FORMATS,
    dataflash_head,
    dataflash_record,
    ulog_data,
    ulog_head,
    ulog_parameter,
    ulog_release,
    ulog_text,
)

G = 9.80665
FLIGHT_S = 40.0
FIRST_STEP_S = 20.0
SWEEP_S = (19.0, 26.0)
"""Begin and end of SystemID's run, s."""
HEALTHY = (0, 0, 30.0, 1, 1)
"""Errors, temperature and health of gyro and accelerometer, as IMU has them."""


def elevator_us(t: float) -> int:
    """A 3-2-1-1 of 0.5 s units between stretches of trim; more PWM is elevator up."""
    unit = (t - FIRST_STEP_S) / 0.5
    for start, end, sign in ((0, 3, 1), (3, 5, -1), (5, 6, 1), (6, 7, -1)):
        if start <= unit < end:
            return 1500 + 40 * sign
    return 1500


def motion(t: float) -> tuple[float, float]:
    """Pitch angle and rate of an aircraft that follows its elevator within 0.1 s, besides some motion."""
    theta, q = 0.05 + 0.01 * math.sin(t), 0.01 * math.cos(t)
    for unit, change in ((0, 1), (3, -2), (5, 2), (6, -2), (7, 1)):
        since = t - FIRST_STEP_S - 0.5 * unit
        if since > 0.0:
            q += 0.1 * change * (1.0 - math.exp(-since / 0.1))
            theta += 0.1 * change * (since - 0.1 * (1.0 - math.exp(-since / 0.1)))
    return theta, q


def dataflash_flight(seconds=FLIGHT_S, changes=None, switched=False, swept_axis=None):
    """A flight; ``changes`` has the modes that it is put into, by the time in s. The texts of SystemID on
    ``swept_axis``, around the manoeuvre, are lost."""
    log = [dataflash_head()]
    log.append(dataflash_record("VER", 900, 0, 0, 4, 5, 6, 255, 0, b"ArduPlane V4.5.6", 0, 3, 0))
    log.append(dataflash_record("MSG", 1000, b"ArduPlane V4.5.6 (0123abcd)"))
    parameters = {"SERVO2_FUNCTION": 19, "SERVO2_MIN": 1100, "SERVO2_TRIM": 1500, "SERVO2_MAX": 1900}
    log += [dataflash_record("PARM", 2000, name.encode(), value) for name, value in parameters.items()]
    log.append(dataflash_record("MODE", 3000, 0, 0, 1))
    for i in range(round(seconds * 50)):
        us = 1_000_000 + 20_000 * i
        t = us * 1e-6
        theta, q = motion(t)
        log += [
            dataflash_record("MODE", us, mode, mode, 1)
            for at_s, mode in (changes or {}).items()
            if t <= at_s < t + 0.02
        ]
        log.append(dataflash_record("IMU", us, 0, 0.0, q, 0.0, 0.1, 0.0, -G, *HEALTHY))
        log.append(dataflash_record("IMU", us, 1, 9.0, 9.0, 9.0, 9.0, 9.0, 9.0, *HEALTHY))
        log.append(dataflash_record("RCOU", us + 300, 1500, elevator_us(t), 1400, 1500))
        if swept_axis is not None and SWEEP_S[0] <= t < SWEEP_S[1]:
            if t < SWEEP_S[0] + 0.02:
                log.append(dataflash_record("SIDS", us + 400, swept_axis, 5.0, 0.5, 5.0, 2.0, 4.0, 7.0, 1.0))
            log.append(dataflash_record("SIDD", us + 400, t - SWEEP_S[0]))
        if i % 2 == 0:
            log.append(dataflash_record("ATT", us + 600, 0.0, 1.0, 0.0, math.degrees(theta), 0.0, 90.0))
            log.append(dataflash_record("AOA", us + 700, 3.5, 0.2))
        if i % 5 == 0:
            log.append(dataflash_record("BARO", us + 800, 0, 120.0, 1e5, 20.0, 0.75))
            log.append(dataflash_record("XKF1", us + 900, 0, 0.0, 0.0, 0.0, 20.0, 5.0, -0.5))
            log.append(dataflash_record("CTUN", us + 1000, 0.0, 0.0, 0.0, 0.0, 45.0, 0.0, 0.0, 24.5))
            log.append(dataflash_record("ARSP", us + 1100, 0, 25.0, 0.0, 0.0, 0.0, 0.0, 1, 1))
            log.append(dataflash_record("POS", us + 1200, 47.1, 8.5, 500.0, 100.25))
            if switched:
                log.append(dataflash_record("RCIN", us + 1250, *[1500] * 8, switch_us(t)))
        if i % 50 == 0:
            log.append(dataflash_record("GPS", us + 1300, 0, 3, 100_000_000 + 1000 * (i // 50), 2300))
    return b"".join(log)


def switch_us(t: float) -> int:
    """A pilot's switch on channel 9, on around the manoeuvre."""
    return 1900 if FIRST_STEP_S - 1.0 <= t < FIRST_STEP_S + 6.0 else 1100


def px4_flight(seconds: float = FLIGHT_S, switched: bool = False, **parameters: float) -> bytes:
    definitions = [ulog_parameter(name, value) for name, value in parameters.items()]
    log = [ulog_head(ulog_release(0x010F02FF), *definitions)]
    log.append(ulog_text(900_000, 6, "[logger] start"))
    for i in range(round(seconds * 50)):
        us = 1_000_000 + 20_000 * i
        t = us * 1e-6
        theta, q = motion(t)
        half = theta / 2
        log.append(ulog_data("sensor_combined", us, (0.0, q, 0.0), (0.1, 0.0, -G)))
        log.append(ulog_data("vehicle_angular_velocity", us + 150, us + 100, (0.0, q, 0.0)))
        log.append(
            ulog_data("vehicle_attitude", us + 500, us + 400, (math.cos(half), 0.0, math.sin(half), 0.0))
        )
        outputs = [900.0] * 16
        outputs[1] = float(elevator_us(t))
        log.append(ulog_data("actuator_outputs", us + 700, 8, outputs))
        if i % 5 == 0:
            log.append(ulog_data("vehicle_local_position", us + 800, us + 790, -100.25, -0.5))
            log.append(ulog_data("vehicle_thrust_setpoint", us + 900, (0.45, 0.0, 0.0)))
            log.append(ulog_data("airspeed_validated", us + 1000, 25.0))
            log.append(ulog_data("debug_key_value", us + 1100, b"vane", 3.5))
            if switched:
                log.append(ulog_data("input_rc", us + 1150, [*[1500] * 8, switch_us(t), *[0] * 9]))
        if i % 50 == 0:
            log.append(ulog_data("vehicle_status", us + 1200, 0 if i < 500 else 3, 2))
            log.append(ulog_data("vehicle_gps_position", us + 1300, 1_770_000_000_000_000 + us + 1300))
    return b"".join(log)


def read(tmp_path: Path, content: bytes, name: str = "flight.bin") -> dict[str, Columns]:
    path = tmp_path / name
    path.write_bytes(content)
    columns = [c for batch in open_log(path) for c in batch]
    assert len({c.name for c in columns}) == len(columns)
    order = np.concatenate([c.order for c in columns])
    assert len(np.unique(order)) == len(order)
    assert all(np.all(np.diff(c.order) > 0) for c in columns)
    return {c.name: c for c in columns}


def finite(column: Columns, field: str) -> np.ndarray:
    values = np.asarray(column.fields[field], dtype=np.float64)
    return values[np.isfinite(values)]


class TestArduPilot:
    def test_every_field_reads_as_by_pymavlink(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.bin"
        path.write_bytes(dataflash_flight())
        (stretch,) = read_stretches(path, FORMATS)
        tables = stretch.tables
        counts = dict.fromkeys(tables, 0)
        with DFReader.DFReader_binary(str(path)) as log:
            while (theirs := log.recv_msg()) is not None:
                name = theirs.get_type()
                if name not in tables:
                    continue
                row = counts[name]
                counts[name] += 1
                for field in theirs.get_fieldnames():
                    ours = tables[name].fields[field][row].item()
                    expected = getattr(theirs, field)
                    expected = expected.encode() if isinstance(expected, str) else expected
                    assert ours == expected, (name, field)
        assert counts == {name: len(table) for name, table in tables.items()}
        assert counts.keys() >= {"ATT", "AOA", "IMU", "RCOU", "CTUN", "ARSP", "PARM", "MODE", "MSG", "VER"}

    def test_angles_and_rates_keep_their_own_stamps(self, tmp_path: Path) -> None:
        attitude = read(tmp_path, dataflash_flight())["ATTITUDE"]
        angles, rates = np.isfinite(attitude.fields["pitch"]), np.isfinite(attitude.fields["pitchspeed"])
        assert not np.any(angles & rates)
        t = attitude.fields["time_boot_ms"] / 1000.0
        np.testing.assert_allclose(
            attitude.fields["pitch"][angles], [motion(s)[0] for s in t[angles] - 0.0006], atol=2e-4
        )
        np.testing.assert_allclose(
            attitude.fields["pitchspeed"][rates], [motion(s)[1] for s in t[rates]], rtol=1e-6
        )
        assert attitude.fields["roll"][angles][0] == pytest.approx(math.radians(1.0))

    def test_the_first_sensor_counts(self, tmp_path: Path) -> None:
        imu = read(tmp_path, dataflash_flight())["HIGHRES_IMU"]
        assert len(imu) == FLIGHT_S * 50
        np.testing.assert_allclose(imu.fields["zacc"], -G, rtol=1e-6)

    def test_air_data_come_as_the_vehicle_would_report_them(self, tmp_path: Path) -> None:
        hud = read(tmp_path, dataflash_flight())["VFR_HUD"]
        assert set(finite(hud, "airspeed").tolist()) == {25.0}  # ARSP, not the estimate in CTUN
        assert set(finite(hud, "climb").tolist()) == {0.5}  # the filter's, not the barometer's
        assert set(finite(hud, "throttle").tolist()) == {45.0}

    def test_vehicle_mode_parameters_and_texts_are_there(self, tmp_path: Path) -> None:
        messages = read(tmp_path, dataflash_flight())
        heartbeat = messages["HEARTBEAT"]
        assert heartbeat.order[0] == 0
        assert set(heartbeat.fields["autopilot"].tolist()) == {3}
        assert set(heartbeat.fields["type"].tolist()) == {1}
        assert heartbeat.fields["custom_mode"].tolist() == [0, 0, 0]
        assert messages["PARAM_VALUE"].fields["param_id"].tolist()[0] == b"SERVO2_FUNCTION"
        assert messages["STATUSTEXT"].fields["text"].tolist() == [b"ArduPlane V4.5.6 (0123abcd)"]
        assert messages["STATUSTEXT"].fields["severity"].tolist() == [255]
        assert messages["AUTOPILOT_VERSION"].fields["flight_sw_version"].tolist() == [0x040506FF]
        assert finite(messages["GLOBAL_POSITION_INT"], "relative_alt")[0] == 100_250.0

    @pytest.mark.parametrize("name", [b"SYSID_THISMAV", b"MAV_SYSID"])
    def test_the_system_id_is_that_of_the_parameters(self, tmp_path: Path, name: bytes) -> None:
        messages = read(tmp_path, dataflash_flight() + dataflash_record("PARM", 90_000_000, name, 7))
        assert {columns.system for columns in messages.values()} == {7}

    def test_times_of_arrival_come_from_gps(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.bin"
        path.write_bytes(dataflash_flight())
        aoa = read(tmp_path, dataflash_flight())["AOA_SSA"]
        with DFReader.DFReader_binary(str(path)) as log:
            theirs = log.recv_match(type="AOA")
        assert aoa.arrival_s[0] == pytest.approx(theirs._timestamp, abs=1e-3)

    def test_a_stopped_stream_of_outputs_beyond_14_is_held(self, tmp_path: Path) -> None:
        log = dataflash_flight() + b"".join(
            record
            for i in range(10)
            for record in (
                dataflash_record("RCO2", 50_000_000 + 20_000 * i, 1515, 1516, 1517, 1518),
                dataflash_record("RCOU", 50_000_100 + 20_000 * i, 1501, 1502),
            )
        )
        path = tmp_path / "flight.bin"
        path.write_bytes(log)
        banks = [c for batch in open_log(path, ["SERVO_OUTPUT_RAW"]) for c in batch]
        assert [int(bank.fields["port"][0]) for bank in banks] == [0, 1]
        assert banks[0].fields["servo2_raw"][-1] == 1502
        assert banks[0].fields["servo16_raw"][-1] == 1516
        assert banks[1].fields["servo2_raw"][-1] == 1518
        assert not set(banks[0].order.tolist()) & set(banks[1].order.tolist())

    def test_outputs_beyond_14_are_those_of_the_same_loop(self, tmp_path: Path) -> None:
        log = dataflash_flight() + b"".join(
            record
            for i in range(10)
            for record in (
                dataflash_record("RCOU", 50_000_000 + 20_000 * i, 1500 + i, 1502),
                dataflash_record("RCO2", 50_000_030 + 20_000 * i, 1600 + i, 1516, 1517, 1518),
            )
        )
        path = tmp_path / "flight.bin"
        path.write_bytes(log)
        (first, _) = [c for batch in open_log(path, ["SERVO_OUTPUT_RAW"]) for c in batch]
        apart = first.fields["servo15_raw"] - first.fields["servo1_raw"]
        assert apart[-10:].tolist() == [100] * 10

    def test_damage_costs_the_records_it_hits(self, tmp_path: Path) -> None:
        content = bytearray(dataflash_flight())
        whole = read(tmp_path, bytes(content))["AOA_SSA"]
        middle = len(content) // 2
        # Two loops with one AOA record between them hold less than 600 bytes.
        content[middle : middle + 600] = bytes(600)
        del content[middle + 5000 : middle + 5037]
        damaged = read(tmp_path, bytes(content[:-7]))["AOA_SSA"]
        assert len(whole) - 10 < len(damaged) < len(whole)
        assert set(damaged.fields["AOA"].tolist()) == {3.5}
        assert np.all(np.isin(damaged.fields["time_usec"], whole.fields["time_usec"]))

    def test_records_of_another_kind_of_vehicle_count_as_missing(self, tmp_path: Path) -> None:
        content = dataflash_flight(seconds=2.0)
        copter = content.replace(b"ThD,As,SAs", b"ThD,Xs,SAs").replace(
            b"TimeUS,I,Airspeed", b"TimeUS,I,Other_one"
        )
        assert not len(finite(read(tmp_path, copter)["VFR_HUD"], "airspeed"))
        assert len(finite(read(tmp_path, content)["VFR_HUD"], "airspeed"))

    def test_the_manoeuvre_in_it_is_found(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.bin"
        path.write_bytes(dataflash_flight())
        stream = hear_log(path).stream
        assert stream.maneuvers == 1
        assert stream.vehicle is not None
        assert str(stream.vehicle) == "ardupilot 1/1"
        assert {"elevator", "q", "alpha", "theta", "a_z", "airspeed"} <= stream.channels.keys()
        assert stream.channels["q"].rate_hz == pytest.approx(50.0, rel=0.01)
        assert stream.channels["theta"].rate_hz == pytest.approx(25.0, rel=0.01)

    @pytest.mark.parametrize("after_s", [1.0, 2.0])
    def test_a_manoeuvre_lasts_until_the_log_says_that_the_mode_changed(self, tmp_path, after_s):
        """Over a link it may have changed any time since the heartbeat before."""
        stream, last_step_s = FlightStream(Aircraft()), FIRST_STEP_S + 7 * 0.5
        path = tmp_path / "flight.bin"
        path.write_bytes(dataflash_flight(changes={0.5: 0, last_step_s + after_s: 12}))
        events = [event for batch in open_log(path) for event in stream.feed(batch)]
        [flown] = [event.maneuver for event in events if isinstance(event, ManeuverFlown)]
        assert flown.mode == "MANUAL"
        assert flown.span.end_s - flown.span.last_step_s == pytest.approx(after_s, abs=0.1)

    def test_a_log_without_flight_data_is_refused(self, tmp_path: Path) -> None:
        path = tmp_path / "empty.bin"
        path.write_bytes(dataflash_head())
        with pytest.raises(UnusableInputError, match=r"empty\.bin holds no ATT, IMU or RCOU"):
            list(open_log(path))


class TestPx4:
    def test_attitude_is_that_of_the_quaternion_when_it_was_sampled(self, tmp_path: Path) -> None:
        attitude = read(tmp_path, px4_flight(), "flight.ulg")["ATTITUDE"]
        angles, rates = np.isfinite(attitude.fields["pitch"]), np.isfinite(attitude.fields["pitchspeed"])
        t = attitude.fields["time_boot_ms"] / 1000.0
        pitch, rate = attitude.fields["pitch"][angles], attitude.fields["pitchspeed"][rates]
        np.testing.assert_allclose(pitch, [motion(s)[0] for s in t[angles]], atol=1e-5)
        np.testing.assert_allclose(rate, [motion(s)[1] for s in t[rates]], atol=1e-5)

    def test_air_data_outputs_and_named_values_are_there(self, tmp_path: Path) -> None:
        messages = read(tmp_path, px4_flight(), "flight.ulg")
        hud = messages["VFR_HUD"]
        assert set(finite(hud, "airspeed").tolist()) == {25.0}
        assert set(finite(hud, "climb").tolist()) == {0.5}
        np.testing.assert_allclose(finite(hud, "throttle"), 45.0, rtol=1e-6)
        assert set(messages["SERVO_OUTPUT_RAW"].fields["servo2_raw"].tolist()) == {1460.0, 1500.0, 1540.0}
        assert set(messages["NAMED_VALUE_FLOAT"].fields["name"].tolist()) == {b"vane"}
        np.testing.assert_allclose(messages["HIGHRES_IMU"].fields["zacc"], -G, rtol=1e-6)
        assert messages["GLOBAL_POSITION_INT"].fields["relative_alt"][0] == pytest.approx(100_250.0)

    def test_vehicle_mode_parameters_and_texts_are_there(self, tmp_path: Path) -> None:
        messages = read(tmp_path, px4_flight(FW_AIRSPD_TRIM=15.0), "flight.ulg")
        heartbeat = messages["HEARTBEAT"]
        assert heartbeat.order[0] == 0
        assert set(heartbeat.fields["autopilot"].tolist()) == {12}
        assert [mode >> 16 for mode in heartbeat.fields["custom_mode"].tolist()][:2] == [1, 1]
        assert heartbeat.fields["custom_mode"].tolist()[-1] == 4 << 16 | 4 << 24  # Mission
        assert messages["PARAM_VALUE"].fields["param_id"].tolist() == [b"FW_AIRSPD_TRIM"]
        assert messages["STATUSTEXT"].fields["text"].tolist() == [b"[logger] start"]
        assert messages["AUTOPILOT_VERSION"].fields["flight_sw_version"].tolist() == [0x010F02FF]
        assert messages["HIGHRES_IMU"].arrival_s[0] == pytest.approx(1_770_000_001.0, abs=0.1)

    @pytest.mark.parametrize(("stated", "kind"), [({}, 1), ({"MAV_TYPE": 2.0}, 2), ({"MAV_TYPE": 22.0}, 22)])
    def test_the_kind_of_vehicle_is_the_one_its_parameter_states(self, tmp_path, stated, kind):
        heartbeat = read(tmp_path, px4_flight(**stated), "flight.ulg")["HEARTBEAT"]
        assert set(heartbeat.fields["type"].tolist()) == {kind}

    def test_the_manoeuvre_in_it_is_found(self, tmp_path: Path) -> None:
        path = tmp_path / "flight.ulg"
        path.write_bytes(px4_flight())
        elevator = Elevator(output=2, calibration=((1000, 25), (2000, -25)))
        stream = hear_log(path, Aircraft(elevator=elevator)).stream
        assert stream.maneuvers == 1
        assert str(stream.vehicle) == "px4 1/1"
        assert stream.channels["q"].rate_hz == pytest.approx(50.0, rel=0.01)

    def test_the_system_id_is_that_of_the_parameters(self, tmp_path: Path) -> None:
        messages = read(tmp_path, px4_flight(MAV_SYS_ID=7), "flight.ulg")
        assert {columns.system for columns in messages.values()} == {7}

    def test_topics_of_another_version_count_as_missing(self, tmp_path: Path) -> None:
        content = px4_flight(seconds=2.0).replace(b"float vz;", b"float wz;")
        messages = read(tmp_path, content, "flight.ulg")
        assert "GLOBAL_POSITION_INT" not in messages
        assert not len(finite(messages["VFR_HUD"], "climb"))

    def test_a_log_cut_off_reads_up_to_the_cut(self, tmp_path: Path) -> None:
        content = px4_flight()
        whole = read(tmp_path, content, "flight.ulg")["HIGHRES_IMU"]
        half = read(tmp_path, content[: len(content) // 2], "flight.ulg")["HIGHRES_IMU"]
        assert 0.4 * len(whole) < len(half) < 0.6 * len(whole)

    @pytest.mark.parametrize(
        "content", [ulog_head(), b"ULog\x01\x12\x35\x01", b"ULog\x01\x12\x35\x01" + bytes(500)]
    )
    def test_a_log_without_flight_data_is_refused(self, tmp_path: Path, content: bytes) -> None:
        path = tmp_path / "empty.ulg"
        path.write_bytes(content)
        with pytest.raises(UnusableInputError, match=r"empty\.ulg holds no attitude"):
            list(open_log(path))

    def test_nothing_is_printed_where_results_belong(self, tmp_path, capsys):
        path = tmp_path / "flight.ulg"
        content = bytearray(px4_flight())
        content[4000:4100] = bytes(100)
        path.write_bytes(content)
        assert list(open_log(path))
        assert capsys.readouterr().out == ""


@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    flight=st.sampled_from([dataflash_flight, px4_flight]),
    damages=st.lists(st.tuples(st.floats(0, 1), st.binary(min_size=1, max_size=40)), min_size=1, max_size=5),
    kept=st.floats(0.3, 1.0),
)
def test_damage_never_crashes_a_reader(flight, damages, kept):
    content = bytearray(flight(1.0))
    for place, garbage in damages:
        at = 16 + int(place * (len(content) - 64))
        content[at : at + len(garbage)] = garbage
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "damaged.log"
        path.write_bytes(content[: int(kept * len(content))])
        with contextlib.suppress(UnusableInputError):
            for batch in open_log(path):
                assert all(len(c) == len(values) for c in batch for values in c.fields.values())


@pytest.mark.parametrize("name", ["flight.bin", "flight.ulg"])
def test_a_pilots_switch_in_the_autopilots_own_log_marks_the_manoeuvre(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(dataflash_flight(switched=True) if name.endswith("bin") else px4_flight(switched=True))
    elevator = Elevator(output=2, calibration=((1000, 25), (2000, -25)))
    (maneuver,) = hear_log(path, Aircraft(elevator=elevator, markers=Markers(rc=9))).maneuvers
    assert maneuver.span.closed_by == "marked by a switch"
    assert maneuver.span.end_s == pytest.approx(FIRST_STEP_S + 6.0, abs=0.11)
