"""The DataFlash log that an autopilot would have written on a flight of which telemetry was recorded."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats.telemetry import read_tlog
from tests.mavlink.autopilot_logs import dataflash_head, dataflash_record

DEFAULT = {"IMU": 50.0, "ATT": 25.0, "RCOU": 25.0, "CTUN": 25.0, "XKF1": 25.0, "ARSP": 10.0, "AOA": 10.0}
"""Records a second with LOG_BITMASK 65535 and a main loop of 50 Hz (FACTS of a flight recorded so)."""
FAST = dict.fromkeys(DEFAULT, 50.0)
FUNCTIONS = {"elevator": {2: 19}, "elevon": {1: 77, 2: 78}, "V-tail": {3: 79, 4: 80}}


def messages_of(log: Path) -> dict[str, Columns]:
    """All messages of the autopilot 1/1, by name."""
    parts: dict[str, list[Columns]] = {}
    for batch in read_tlog(log):
        for c in batch:
            if (c.system, c.component) == (1, 1):
                parts.setdefault(c.name, []).append(c)
    return {name: _joined(columns) for name, columns in parts.items()}


def _joined(parts: list[Columns]) -> Columns:
    fields = {name: np.concatenate([c.fields[name] for c in parts]) for name in parts[0].fields}
    order, arrival_s = (np.concatenate([getattr(c, name) for c in parts]) for name in ("order", "arrival_s"))
    return Columns(parts[0].name, 1, 1, order, arrival_s, fields)


def dataflash_of(log: Path, rates_hz: Mapping[str, float] = DEFAULT, tail: str = "elevator") -> bytes:
    """A DataFlash log of a telemetry log of 50 Hz.

    Parameters
    ----------
    log
        Its elevator is output 2, more pulse is up.
    rates_hz
        Records a second, by name.
    tail
        How the elevator is driven: a key of ``FUNCTIONS``; both halves are then given its pulses.
    """
    heard = messages_of(log)
    attitude, imu, hud = heard["ATTITUDE"], heard["RAW_IMU"], heard["VFR_HUD"]
    boot_us = attitude.fields["time_boot_ms"].astype(np.int64) * 1000
    rows: list[tuple[int, str, tuple[object, ...]]] = []

    def write(record: str, us: np.ndarray, *columns: object) -> None:
        """Some of the samples, as the record's rate has it, each at its own time."""
        due = np.floor(us * 1e-6 * rates_hz[record] + 1e-6)
        kept = np.flatnonzero(np.diff(due, prepend=-1.0) > 0)
        filled = [np.broadcast_to(np.asarray(c), us.shape)[kept].tolist() for c in columns]
        rows.extend((int(t), record, values) for t, *values in zip(us[kept].tolist(), *filled, strict=True))

    hud_us = boot_us[np.maximum(np.searchsorted(attitude.order, hud.order) - 1, 0)]
    degrees = {name: np.degrees(attitude.fields[name]) for name in ("roll", "pitch", "yaw")}
    write("ATT", boot_us, 0.0, degrees["roll"], 0.0, degrees["pitch"], 0.0, degrees["yaw"])
    g = GRAVITY_M_S2 / 1000.0
    imu_us = imu.fields["time_usec"].astype(np.int64)
    rates = [imu.fields[f"{axis}gyro"] / 1000.0 for axis in "xyz"]
    write("IMU", imu_us, 0, *rates, *(g * imu.fields[f"{axis}acc"] for axis in "xyz"), 0, 0, 25.0, 1, 1)
    servo = heard["SERVO_OUTPUT_RAW"]
    pulses = {n: servo.fields[f"servo{n}_raw"].astype(int) for n in range(1, 9)}
    halves = list(FUNCTIONS[tail])
    elevator = servo.fields["servo2_raw"].astype(int)
    # A turn in the other axis, which the mean of a mixed pair must cancel.
    other = np.round(15.0 * np.sin(servo.arrival_s)).astype(int) if len(halves) > 1 else 0
    for n, sign in zip(halves, (1, -1), strict=False):
        pulses[n] = elevator + sign * other
    write("RCOU", servo.fields["time_usec"].astype(np.int64), *pulses.values())
    aoa = heard["AOA_SSA"]
    write("AOA", aoa.fields["time_usec"].astype(np.int64), aoa.fields["AOA"], aoa.fields["SSA"])
    write("CTUN", hud_us, 0.0, 0.0, 0.0, 0.0, hud.fields["throttle"], 0, 0.0, hud.fields["airspeed"])
    write("XKF1", hud_us, 0, 0.0, 0.0, 0.0, 0.0, 0.0, -hud.fields["climb"])
    write("ARSP", hud_us, 0, hud.fields["airspeed"], 0.0, 0.0, 0.0, 0.0, 1, 1)
    beat = heard["HEARTBEAT"]
    beat_us = boot_us[np.maximum(np.searchsorted(attitude.order, beat.order) - 1, 0)]
    modes = beat.fields["custom_mode"].astype(int)
    changed = np.flatnonzero(np.diff(modes, prepend=-1) != 0)
    rows += [(int(beat_us[i]), "MODE", (int(modes[i]), int(modes[i]), 1)) for i in changed]
    rows.sort(key=lambda row: row[0])
    start_us = rows[0][0]
    parameters = {f"SERVO{n}_FUNCTION": function for n, function in FUNCTIONS[tail].items()}
    for n in parameters and halves:
        parameters |= {f"SERVO{n}_MIN": 1100, f"SERVO{n}_TRIM": 1500, f"SERVO{n}_MAX": 1900}
        parameters[f"SERVO{n}_REVERSED"] = 0
    head = [dataflash_head(), dataflash_record("VER", start_us, 0, 0, 4, 5, 6, 255, 0, b"", 0, 3, 0)]
    head += [dataflash_record("PARM", start_us, name.encode(), value) for name, value in parameters.items()]
    return b"".join([*head, *(dataflash_record(name, us, *values) for us, name, values in rows)])
