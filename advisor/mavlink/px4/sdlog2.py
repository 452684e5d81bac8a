"""PX4's log before ULog (``.px4log``, "sdlog2"): DataFlash's container with PX4's own records.

A record of sdlog2 has no time of its own. A TIME record precedes all records of one round of the logger (PX4,
sdlog2_messages.h of 2013 to 2016). Angles and rates are in rad, accelerations in m/s².
"""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from advisor.flight.signals.messages import Columns
from advisor.mavlink.records.dataflash import RecordTable, parameters_in, seconds
from advisor.mavlink.records.equivalent import (
    MAV_PARAM_TYPE_REAL32,
    MAV_TYPE_FIXED_WING,
    latest,
    message,
    milliseconds,
    system_id,
)
from advisor.process.arrays import FloatArray

SDLOG2_RECORDS: dict[str, set[str]] = {
    "TIME": {"StartTime"},
    "AIRS": {"IndSpeed"},
    "ATT": {"Roll", "Pitch", "Yaw", "RollRate", "PitchRate", "YawRate"},
    "ATTC": {"Thrust"},
    "GPS": {"GPSTime"},
    "IMU": {"AccX", "AccY", "AccZ", "GyroX", "GyroY", "GyroZ"},
    "LPOS": {"Z", "VZ"},
    "OUT0": {"Out0", "Out7"},
    "PARM": {"Name", "Value"},
    "STAT": {"MainState"},
}
"""Necessary fields of each record, by the record's name."""
_PX4 = 12  # MAV_AUTOPILOT
_MAIN_MODES = {0: 1, 1: 2, 2: 3, 6: 5, 7: 6, 8: 7}
"""Main mode of PX4's custom_mode for each STAT.MainState. Any other state is an automatic mode."""
_AUTO = 4


def is_sdlog2(tables: Mapping[str, RecordTable]) -> bool:
    """Return whether records of a DataFlash container are PX4's."""
    return "TIME" in tables and "StartTime" in tables["TIME"].fields


class Sdlog2Messages:
    """Conversion of the records to the messages that telemetry would have carried."""

    def __init__(self, tables: Mapping[str, RecordTable]) -> None:
        known = {
            name: tables[name]
            for name, needed in SDLOG2_RECORDS.items()
            if name in tables and needed <= tables[name].fields.keys()
        }
        rounds = known.pop("TIME")
        time_us = rounds.fields["StartTime"].astype(np.int64)
        self._tables: dict[str, RecordTable] = {}
        for name, table in known.items():
            at = np.maximum(np.searchsorted(rounds.order, table.order) - 1, 0)
            self._tables[name] = replace(table, fields={**table.fields, "TimeUS": time_us[at]})
        self._base_s = self._unix_time_base_s()
        stored = dict(parameters_in(self._tables))
        self._system = system_id(stored.get(b"MAV_SYS_ID"))
        self._type = int(stored.get(b"MAV_TYPE", MAV_TYPE_FIXED_WING))

    def columns(self) -> Iterator[Columns]:
        """Yield the messages of each type."""
        yield self._heartbeat()
        if "PARM" in self._tables:
            parm = self._tables["PARM"]
            named: dict[str, ArrayLike] = {
                "param_id": parm.fields["Name"],
                "param_value": parm.fields["Value"],
            }
            yield self._message("PARAM_VALUE", parm, {**named, "param_type": MAV_PARAM_TYPE_REAL32})
        if "ATT" in self._tables:
            att = self._tables["ATT"]
            names = {f"{axis}speed": f"{axis.capitalize()}Rate" for axis in ("roll", "pitch", "yaw")}
            names |= {axis: axis.capitalize() for axis in ("roll", "pitch", "yaw")}
            fields = {ours: att.fields[theirs] for ours, theirs in names.items()}
            yield self._message("ATTITUDE", att, {**fields, "time_boot_ms": milliseconds(att.time_us)})
        if "IMU" in self._tables:
            imu = self._tables["IMU"]
            fields = {f"{axis.lower()}acc": imu.fields[f"Acc{axis}"] for axis in "XYZ"}
            fields |= {f"{axis.lower()}gyro": imu.fields[f"Gyro{axis}"] for axis in "XYZ"}
            yield self._message("HIGHRES_IMU", imu, {**fields, "time_usec": imu.time_us})
        if "OUT0" in self._tables:
            out = self._tables["OUT0"]
            fields = {f"servo{n + 1}_raw": out.fields[f"Out{n}"] for n in range(8)}
            yield self._message("SERVO_OUTPUT_RAW", out, {**fields, "time_usec": out.time_us, "port": 0})
        if "AIRS" in self._tables:
            air = self._tables["AIRS"]
            yield self._message(
                "VFR_HUD",
                air,
                {
                    "airspeed": air.fields["IndSpeed"],
                    "climb": -self._known(air, "LPOS", "VZ"),
                    "throttle": 100.0 * self._known(air, "ATTC", "Thrust"),
                },
            )

    def _message(self, name: str, table: RecordTable, fields: Mapping[str, ArrayLike]) -> Columns:
        arrival_s = self._base_s + seconds(table.time_us)
        return message(name, self._system, table.order, arrival_s, fields, "sdlog2")

    def _heartbeat(self) -> Columns:
        """Return a heartbeat before all other messages, then one at each status."""
        order, states, time_us = np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64)
        if "STAT" in self._tables:
            stat = self._tables["STAT"]
            told = stat.fields["MainState"].astype(np.int64)
            order, states = np.append(order, stat.order), np.append(told[:1], told)
            time_us = np.append(stat.time_us[:1], stat.time_us)
        mains = np.array([_MAIN_MODES.get(state, _AUTO) for state in states.tolist()])
        table = RecordTable(order, {"TimeUS": time_us})
        fields: dict[str, ArrayLike] = {"type": self._type, "autopilot": _PX4, "base_mode": 1}
        return self._message("HEARTBEAT", table, {**fields, "custom_mode": mains << 16})

    def _known(self, at: RecordTable, record: str, field: str) -> FloatArray:
        table = self._tables.get(record)
        if table is None:
            return np.full(len(at), np.nan)
        return latest(at.order, table.order, table.fields[field])

    def _unix_time_base_s(self) -> float:
        """Return the time of boot, seconds since 1970, from the first fix with a date; 0 without one."""
        if "GPS" not in self._tables:
            return 0.0
        gps = self._tables["GPS"]
        dated = np.flatnonzero(gps.fields["GPSTime"] > 0)
        if not len(dated):
            return 0.0
        first = dated[0]
        return float(gps.fields["GPSTime"][first].astype(np.int64) - gps.time_us[first]) * 1e-6
