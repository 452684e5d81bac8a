"""What an ArduPilot log says, as the messages its telemetry would have carried."""

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.identity import READER
from advisor.flight.messages import Columns, IntArray
from advisor.mavlink.dataflash import Table, gps_time_base_s, read_tables, seconds
from advisor.mavlink.equivalent import MAV_PARAM_TYPE_REAL32, MAV_TYPE_FIXED_WING, latest, message, system_id
from advisor.mavlink.sensors import flown, said
from advisor.problems import UnusableInputError

_RECORDS: dict[str, set[str]] = {
    "AOA": {"AOA", "SSA"},
    "ARSP": {"Airspeed"},
    "ATT": {"Roll", "Pitch", "Yaw"},
    "BARO": {"CRt"},
    "CTUN": {"As"},
    "GPS": {"GWk", "GMS"},
    "IMU": {"GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"},
    "MODE": {"ModeNum"},
    "MSG": {"Message"},
    "PARM": {"Name", "Value"},
    "POS": {"Lat", "Lng", "Alt", "RelHomeAlt"},
    "RCIN": {"C1"},
    "RCOU": {"C1"},
    "RCO2": set(),
    "RCO3": set(),
    "VER": {"Maj", "Min", "Pat", "FWT"},
    "XKF1": {"VD"},
}
"""Records, and the fields needed of each: without them (another kind of vehicle, an older version)
a record counts as missing."""
_SENSORS = {"ARSP": "Air speed", "IMU": "Angular rates and specific force"}
"""Records of which a vehicle may carry several, and the quantities that they hold."""
_ARDUPILOTMEGA = 3  # MAV_AUTOPILOT
_BUILD_TO_MAV_TYPE = {1: 10, 2: 2, 3: MAV_TYPE_FIXED_WING, 4: 5, 7: 12, 12: 7, 13: 4}
"""VER.BU: rover, copter, plane, antenna tracker, submarine, airship, helicopter."""
_TITLES = {"ArduPlane": MAV_TYPE_FIXED_WING, "ArduCopter": 2, "ArduRover": 10, "ArduSub": 12}
"""Firmware names in MSG, for logs older than VER."""


def read_dataflash(path: Path, wanted: Iterable[str] | None = None) -> Iterator[list[Columns]]:
    """The messages of a ``.bin``, in one batch.

    Raises
    ------
    UnusableInputError
        When it holds neither attitude, inertial sensors, nor servo outputs.
    """
    tables = {
        name: table
        for name, table in read_tables(path, _RECORDS).items()
        if _RECORDS[name] <= table.fields.keys()
    }
    if not tables.keys() & {"ATT", "IMU", "RCOU"}:
        raise UnusableInputError(
            "no_messages",
            f"{path.name} holds no ATT, IMU or RCOU records.",
            "Set LOG_BITMASK so that attitude, IMU and RC output are logged, or give a .tlog.",
        )
    names = None if wanted is None else set(wanted)
    with np.errstate(over="ignore", invalid="ignore"):  # damaged records hold any number
        columns = list(_Translation(tables).columns())
    columns = [c for c in columns if len(c) and (names is None or c.name in names)]
    if columns:
        yield columns


class _Translation:
    def __init__(self, tables: dict[str, Table]) -> None:
        self._tables = {name: flown(table) if name in _SENSORS else table for name, table in tables.items()}
        self._base_s = gps_time_base_s(tables.get("GPS"))
        self._system = self._system_id()

    def columns(self) -> Iterator[Columns]:
        yield self._heartbeat()
        translations = {
            "ATT": self._attitude,
            "IMU": self._highres_imu,
            "AOA": self._aoa_ssa,
            "POS": self._global_position_int,
            "RCIN": self._rc_channels,
            "PARM": self._param_value,
            "VER": self._autopilot_version,
        }
        if "ATT" not in self._tables and "IMU" in self._tables:
            yield self._attitude(None)
        for name, translate in translations.items():
            if name in self._tables:
                yield translate(self._tables[name])
        yield from self._servo_outputs()
        air = self._tables.get("ARSP", self._tables.get("CTUN"))
        if air is not None:
            yield self._vfr_hud(air)
        yield self._statustext()

    def _system_id(self) -> int:
        """As the parameters give it, under its old or its new name."""
        parm = self._tables.get("PARM")
        if parm is not None:
            for name, value in zip(parm.fields["Name"].tolist(), parm.fields["Value"].tolist(), strict=True):
                if name in (b"SYSID_THISMAV", b"MAV_SYSID"):
                    return system_id(value)
        return system_id(None)

    def _message(self, name: str, table: Table, fields: dict[str, ArrayLike], place: int = 0) -> Columns:
        """A message made of each record; ``place`` keeps several made of one record in order."""
        return self._made(name, table.order + place, table.time_us, fields)

    def _made(self, name: str, order: IntArray, time_us: IntArray, fields: dict[str, ArrayLike]) -> Columns:
        arrival_s = self._base_s + seconds(time_us)
        return message(name, self._system, order, arrival_s, fields, "dataflash")

    def _attitude(self, att: Table | None) -> Columns:
        """Angles at the stamps of ATT, rates at those of IMU."""
        rows: list[tuple[Table, NDArray[np.float64]]] = []
        if att is not None:
            angles = np.radians([att.fields[axis] for axis in ("Roll", "Pitch", "Yaw")])
            rows.append((att, np.vstack([angles, np.full_like(angles, np.nan)])))
        if "IMU" in self._tables:
            imu = self._tables["IMU"]
            rates = np.array([imu.fields[axis] for axis in ("GyrX", "GyrY", "GyrZ")], dtype=np.float64)
            rows.append((imu, np.vstack([np.full_like(rates, np.nan), rates])))
        order = np.concatenate([table.order for table, _ in rows])
        time_us = np.concatenate([table.time_us for table, _ in rows])
        values = np.hstack([values for _, values in rows])
        names = ("roll", "pitch", "yaw", "rollspeed", "pitchspeed", "yawspeed")
        fields: dict[str, Any] = dict(zip(names, values, strict=True))
        fields["time_boot_ms"] = _milliseconds(time_us)
        return self._made("ATTITUDE", order, time_us, fields)

    def _highres_imu(self, imu: Table) -> Columns:
        fields: dict[str, ArrayLike] = {"time_usec": imu.time_us}
        for axis in "XYZ":
            fields[f"{axis.lower()}acc"] = imu.fields[f"Acc{axis}"]
            fields[f"{axis.lower()}gyro"] = imu.fields[f"Gyr{axis}"]
        return self._message("HIGHRES_IMU", imu, fields, place=1)

    def _aoa_ssa(self, aoa: Table) -> Columns:
        angles = {"AOA": aoa.fields["AOA"], "SSA": aoa.fields["SSA"]}
        return self._message("AOA_SSA", aoa, {"time_usec": aoa.time_us, **angles})

    def _servo_outputs(self) -> Iterator[Columns]:
        """RCOU has outputs 1 to 14, RCO2 15 to 18, RCO3 19 to 32; each bank of 16 is one message."""
        pulses: dict[int, NDArray[Any]] = {}
        if "RCOU" not in self._tables:
            return
        rcou = self._tables["RCOU"]
        for name in ("RCOU", "RCO2", "RCO3"):
            if name in self._tables:
                table = self._tables[name]
                for field, values in table.fields.items():
                    if field[0] == "C" and field[1:].isdigit():
                        # The autopilot writes the records of one loop's outputs one after the other.
                        at = _nearest(rcou.time_us, table.time_us)
                        pulses[int(field[1:])] = values if table is rcou else values[at]
        banks = []
        for port in range(2):
            outputs = {
                f"servo{number - 16 * port}_raw": values
                for number, values in pulses.items()
                if 16 * port < number <= 16 * port + 16
            }
            if outputs:
                fields: dict[str, ArrayLike] = {"time_usec": rcou.time_us, "port": port, **outputs}
                banks.append(self._message("SERVO_OUTPUT_RAW", rcou, fields, place=port))
        yield from banks

    def _rc_channels(self, rcin: Table) -> Columns:
        pulses: dict[str, ArrayLike] = {
            f"chan{field[1:]}_raw": values
            for field, values in rcin.fields.items()
            if field[0] == "C" and field[1:].isdigit()
        }
        return self._message("RC_CHANNELS", rcin, {"time_boot_ms": _milliseconds(rcin.time_us), **pulses})

    def _vfr_hud(self, air: Table) -> Columns:
        fields: dict[str, ArrayLike] = {
            "airspeed": air.fields["Airspeed" if "Airspeed" in air.fields else "As"],
            "throttle": self._known(air, "CTUN", ("ThO", "ThrOut")),
            "alt": self._known(air, "POS", ("RelHomeAlt",)),
        }
        climb = -self._known(air, "XKF1", ("VD",))
        fields["climb"] = np.where(np.isnan(climb), self._known(air, "BARO", ("CRt",)), climb)
        return self._message("VFR_HUD", air, fields, place=1)

    def _known(self, at: Table, record: str, names: tuple[str, ...]) -> NDArray[np.float64]:
        """The newest value of a field in another record, NaN where there is none."""
        table = self._tables.get(record)
        if table is not None:
            table = table.first_instance()
            for name in names:
                if name in table.fields:
                    return latest(at.order, table.order, table.fields[name])
        return np.full(len(at), np.nan)

    def _global_position_int(self, pos: Table) -> Columns:
        fields: dict[str, ArrayLike] = {
            "time_boot_ms": _milliseconds(pos.time_us),
            "lat": np.round(pos.fields["Lat"] * 1e7).astype(np.int64),
            "lon": np.round(pos.fields["Lng"] * 1e7).astype(np.int64),
            "alt": np.asarray(pos.fields["Alt"] * 1e3, dtype=np.float64),
            "relative_alt": np.asarray(pos.fields["RelHomeAlt"] * 1e3, dtype=np.float64),
        }
        return self._message("GLOBAL_POSITION_INT", pos, fields)

    def _param_value(self, parm: Table) -> Columns:
        fields: dict[str, ArrayLike] = {
            "param_id": parm.fields["Name"],
            "param_value": parm.fields["Value"],
            "param_type": MAV_PARAM_TYPE_REAL32,
            "param_count": len(parm),
            "param_index": np.arange(len(parm)),
        }
        return self._message("PARAM_VALUE", parm, fields)

    def _statustext(self) -> Columns:
        """The vehicle's own texts, and which of several like sensors flew."""
        msg = self._tables.get("MSG")
        own = [] if msg is None else zip(msg.order, msg.time_us, msg.fields["Message"].tolist(), strict=True)
        # A record's own messages take its place and the one after it.
        read = [
            (one.order + 2, one.time_us, READER + one.text.encode())
            for name, quantity in _SENSORS.items()
            if name in self._tables
            for one in said(self._tables[name], quantity)
        ]
        texts = np.array([*own, *read], dtype=[("order", "i8"), ("time_us", "i8"), ("text", "S128")])
        fields: dict[str, ArrayLike] = {"severity": 6, "text": texts["text"]}
        return self._made("STATUSTEXT", texts["order"], texts["time_us"], fields)

    def _autopilot_version(self, ver: Table) -> Columns:
        parts = (ver.fields[name].astype(np.int64) for name in ("Maj", "Min", "Pat", "FWT"))
        major, minor, patch, kind = parts
        return self._message(
            "AUTOPILOT_VERSION",
            ver,
            {"flight_sw_version": major << 24 | minor << 16 | patch << 8 | kind},
        )

    def _heartbeat(self) -> Columns:
        """One before everything else, so that the vehicle is known, and two at each change of mode.

        A log tells of a change when it happens. The mode of before lasted until then, which the first of the
        two says: heard once a second, as over a link, it may have ended any time since the heartbeat before.
        """
        order, modes, time_us = np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64)
        if "MODE" in self._tables:
            mode = self._tables["MODE"]
            numbers = mode.fields["ModeNum"].astype(np.int64)
            changes = np.column_stack([np.append(numbers[:1], numbers[:-1]), numbers])
            order = np.append(order, np.column_stack([mode.order - 1, mode.order]))
            modes = np.append(numbers[:1], changes)
            time_us = np.append(mode.time_us[:1], np.repeat(mode.time_us, 2))
        fields: dict[str, ArrayLike] = {
            "type": self._mav_type(),
            "autopilot": _ARDUPILOTMEGA,
            "base_mode": 1,  # custom_mode is in use
            "custom_mode": modes,
            "mavlink_version": 3,
        }
        return self._made("HEARTBEAT", order, time_us, fields)

    def _mav_type(self) -> int:
        ver, msg = self._tables.get("VER"), self._tables.get("MSG")
        if ver is not None and "BU" in ver.fields:
            return _BUILD_TO_MAV_TYPE.get(int(ver.fields["BU"][0]), MAV_TYPE_FIXED_WING)
        for text in msg.fields["Message"].tolist() if msg is not None else ():
            for title, kind in _TITLES.items():
                if text.startswith(title.encode()):
                    return kind
        return MAV_TYPE_FIXED_WING


def _milliseconds(time_us: NDArray[np.int64]) -> NDArray[np.int64]:
    return (time_us + 500) // 1000


def _nearest(at_us: NDArray[np.int64], time_us: NDArray[np.int64]) -> NDArray[np.int64]:
    """Index of the record nearest to each time asked for, the earlier of two."""
    after = np.clip(np.searchsorted(time_us, at_us), 1, max(len(time_us) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time_us) - 1)
    return np.where(at_us - time_us[before] <= time_us[after] - at_us, before, after)
