"""An ArduPilot log as the messages that its telemetry would have carried."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.signals.messages import Columns, IntArray
from advisor.flight.stream.identity import READER
from advisor.mavlink.ardupilot.ardupilot_air import air
from advisor.mavlink.ardupilot.ardupilot_vehicle import (
    VEHICLE_RECORDS,
    heartbeats,
    in_todays_parameters,
    parameter_fields,
    system_of,
    version_fields,
)
from advisor.mavlink.ardupilot.body_rates import RATE_RECORDS, body_rates, calmed
from advisor.mavlink.ardupilot.former_records import RENAMED, SENSORS_APART, Clocked, in_todays_names
from advisor.mavlink.ardupilot.log_health import HEALTH_RECORDS, health
from advisor.mavlink.ardupilot.sensors import Said, flown, said, silent
from advisor.mavlink.ardupilot.system_identification import SYSTEM_ID_RECORDS, lost_texts, sweeps
from advisor.mavlink.px4.sdlog2 import SDLOG2_RECORDS, Sdlog2Messages, is_sdlog2
from advisor.mavlink.records.dataflash import RecordTable, gps_time_base_s, read_logs, seconds
from advisor.mavlink.records.equivalent import air_data, message, nearest, side_by_side
from advisor.words.problems import UnusableInputError

_RECORDS: dict[str, set[str]] = {
    **VEHICLE_RECORDS,
    **RATE_RECORDS,
    **HEALTH_RECORDS,
    **SYSTEM_ID_RECORDS,
    "ACC": {"AccX", "AccY", "AccZ"},
    "AOA": {"AOA", "SSA"},
    "ARSP": {"Airspeed"},
    "ATT": {"Roll", "Pitch", "Yaw"},
    "BARO": {"CRt"},
    "CTUN": set(),
    "EKF1": {"VD"},
    "GPS": {"GWk", "GMS"},
    "IMU": {"GyrX", "GyrY", "GyrZ", "AccX", "AccY", "AccZ"},
    "NKF1": {"VD"},
    "NKF2": {"VWN", "VWE"},
    "NTUN": {"Arspd"},
    "POS": {"Lat", "Lng", "Alt", "RelHomeAlt"},
    "RCIN": {"C1"},
    "RCOU": {"C1"},
    "RCO2": set(),
    "RCO3": set(),
    "XKF1": {"VD"},
    "XKF2": {"VWN", "VWE"},
}
"""Record to its necessary fields. Without them (another kind of vehicle, an older version) a record counts as
missing."""
_FIELDS = frozenset[str]().union(*_RECORDS.values(), *SDLOG2_RECORDS.values()) | {
    *("TimeUS", "TimeMS", "T", "I", "C"),
    *("As", "BU", "H", "Press", "Pri", "ThO", "U"),
    *(former for renamed in RENAMED.values() for former in renamed),
    *(today for renamed in RENAMED.values() for today in renamed.values()),
}
"""Fields that are read: the necessary ones, the stamps, the number of a sensor, and those that some versions
have."""
_NUMBERED = re.compile(r"(?:C|Ch|Chan|Out)\d+")
"""Fields of one output or channel each."""
_TEXTS = {"Name", "Message"}
"""Fields that hold text. All others are numbers."""
_SENSORS = {"ARSP": "Air speed", "IMU": "Angular rates and specific force"}
"""Record, of which a vehicle may carry several, to the quantities that the record holds."""
_NOT_LOGGED = 255
"""MAV_SEVERITY of a text of MSG, which does not keep the severity (0 to 7)."""


def read_dataflash(path: Path, wanted: Iterable[str] | None = None) -> Iterator[list[Columns]]:
    """Yield the messages of a ``.bin``, or of PX4's ``.px4log`` in its container: one batch for each log that
    was joined into the file.

    Raises
    ------
    UnusableInputError
        The log holds neither attitude, inertial sensors, nor servo outputs.
    """
    apart = (name for names in SENSORS_APART.values() for name in names)
    names = None if wanted is None else set(wanted)
    is_log, newest = False, -1
    for every in read_logs(path, (*_RECORDS, *SDLOG2_RECORDS, *apart), _is_read):
        messages = _messages({name: _believable(every.pop(name)) for name in list(every)})
        if messages is not None:
            is_log = True
            for batch in _batch(messages, names):
                after = [_after(newest, batch, c) for c in batch]
                newest = max(int(c.order[-1]) for c in after)
                yield after
    if not is_log:
        raise UnusableInputError(
            "no_messages",
            f"{path.name} holds no ATT, IMU or RCOU records.",
            "Set LOG_BITMASK so that attitude, IMU and RC output are logged, or give a .tlog.",
        )


def _is_read(field: str) -> bool:
    return field in _FIELDS or _NUMBERED.fullmatch(field) is not None


def _after(newest: int, batch: Sequence[Columns], columns: Columns) -> Columns:
    """Return columns of a batch with orders beyond the newest one of the log before."""
    late_by = newest + 1 - min(int(c.order[0]) for c in batch)
    return replace(columns, order=columns.order + late_by) if newest >= 0 and late_by > 0 else columns


def _messages(stored: Mapping[str, RecordTable]) -> Iterator[Columns] | None:
    """Return the messages of one log; None without attitude, inertial sensors and servo outputs."""
    if is_sdlog2(stored):
        return Sdlog2Messages(stored).columns()
    read = in_todays_names(stored)
    tables = {
        name: table
        for name, table in read.tables.items()
        if name in _RECORDS and _RECORDS[name] <= table.fields.keys()
    }
    if not tables.keys() & {"ATT", "IMU", "RCOU"}:
        return None
    return _Translation(Clocked(tables, read.epoch_s)).columns()


def _believable(table: RecordTable) -> RecordTable:
    """Return the fields whose values fit their names. Damage to a definition can turn a number into a
    text."""
    fields = {
        name: values
        for name, values in table.fields.items()
        if values.ndim == 1 and (values.dtype.kind == "S") == (name in _TEXTS)
    }
    return RecordTable(table.order, fields)


def _batch(columns: Iterator[Columns], names: set[str] | None) -> Iterator[list[Columns]]:
    """Yield all wanted messages in one batch; none where there are none."""
    with np.errstate(over="ignore", invalid="ignore"):  # damaged records hold any number
        wanted = [c for c in columns if len(c) and (names is None or c.name in names)]
    if wanted:
        yield wanted


class _Translation:
    def __init__(self, read: Clocked) -> None:
        self._tables = dict(read.tables)
        self._said: list[Said] = []
        self._interrupted: set[str] = set()
        """Records of sensors that were not healthy all the time."""
        if read.epoch_s:
            self._said.append(Said(0, 0, "Stamps count from 1970: times are given since the first record"))
        for name, quantity in _SENSORS.items():
            if name in self._tables:
                every = self._tables[name]
                self._tables[name] = flown(every)
                self._said += said(every, self._tables[name], quantity)
                if silent(every, self._tables[name]):
                    self._interrupted.add(name)
        self._tables = {name: table for name, table in self._tables.items() if len(table)}
        if "PARM" in self._tables:
            self._tables["PARM"] = in_todays_parameters(self._tables["PARM"])
        self._said += [*health(self._tables), *sweeps(self._tables)]
        self._base_s = float(read.epoch_s) or gps_time_base_s(self._tables.get("GPS"))
        self._system = system_of(self._tables)

    def columns(self) -> Iterator[Columns]:
        """Yield the messages of each type. Records that no later message needs are dropped on the way."""
        order, time_us, fields = heartbeats(self._tables)
        yield self._made("HEARTBEAT", order, time_us, fields)
        yield from self._attitude()
        yield from self._highres_imu()
        self._drop("ATT", "IMU", "ACC", *RATE_RECORDS)
        translations = {
            "AOA": self._aoa_ssa,
            "POS": self._global_position_int,
            "RCIN": self._rc_channels,
        }
        for name, translate in translations.items():
            if name in self._tables:
                yield translate(self._tables.pop(name))
        if "PARM" in self._tables:
            yield self._message("PARAM_VALUE", self._tables["PARM"], parameter_fields(self._tables["PARM"]))
        if "VER" in self._tables:
            yield self._message("AUTOPILOT_VERSION", self._tables["VER"], version_fields(self._tables["VER"]))
        if "BARO" in self._tables and "Press" in self._tables["BARO"].fields:
            yield self._scaled_pressure(self._tables["BARO"].first_instance())
        yield from self._servo_outputs()
        self._drop("RCOU", "RCO2", "RCO3")
        yield from self._vfr_hud()
        blown = next((self._tables[name] for name in ("XKF2", "NKF2") if name in self._tables), None)
        if blown is not None:
            yield self._wind(blown.first_instance())
        yield self._statustext()

    def _drop(self, *names: str) -> None:
        for name in names:
            self._tables.pop(name, None)

    def _message(
        self, name: str, table: RecordTable, fields: dict[str, ArrayLike], place: int = 0
    ) -> Columns:
        """Return one message for each row of a record. ``place`` keeps several messages of one row in
        order."""
        return self._made(name, table.order + place, table.time_us, fields)

    def _made(self, name: str, order: IntArray, time_us: IntArray, fields: dict[str, ArrayLike]) -> Columns:
        arrival_s = self._base_s + seconds(time_us)
        return message(name, self._system, order, arrival_s, fields, "dataflash")

    def _attitude(self) -> Iterator[Columns]:
        """Yield angles at the stamps of ATT, rates at those of their own records."""
        blocks: list[dict[str, NDArray[Any]]] = []
        if "ATT" in self._tables:
            att = self._tables["ATT"]
            angles = {axis.lower(): np.radians(att.fields[axis]) for axis in ("Roll", "Pitch", "Yaw")}
            blocks.append({"order": att.order, "time_us": att.time_us, **angles})
        rates = body_rates(self._tables)
        if rates is not None:
            turned = dict(zip(("rollspeed", "pitchspeed", "yawspeed"), rates.values, strict=True))
            blocks.append({"order": rates.order, "time_us": rates.time_us, **turned})
            if rates.said:
                text = f"The log holds no IMU records: the angular rates are {rates.said}"
                self._said.append(Said(int(rates.order[0]), int(rates.time_us[0]), text))
        if blocks:
            fields: dict[str, Any] = side_by_side(*blocks)
            order, time_us = fields.pop("order"), fields.pop("time_us")
            yield self._made("ATTITUDE", order, time_us, fields | {"time_boot_ms": _milliseconds(time_us)})

    def _highres_imu(self) -> Iterator[Columns]:
        if "IMU" in self._tables:
            imu = self._tables["IMU"]
        elif "ACC" in self._tables:
            imu = calmed(self._tables["ACC"])
        else:
            return
        fields: dict[str, ArrayLike] = {"time_usec": imu.time_us}
        for axis in "XYZ":
            fields[f"{axis.lower()}acc"] = imu.fields[f"Acc{axis}"]
            if f"Gyr{axis}" in imu.fields:
                fields[f"{axis.lower()}gyro"] = imu.fields[f"Gyr{axis}"]
        yield self._message("HIGHRES_IMU", imu, fields, place=1)

    def _aoa_ssa(self, aoa: RecordTable) -> Columns:
        angles = {"AOA": aoa.fields["AOA"], "SSA": aoa.fields["SSA"]}
        return self._message("AOA_SSA", aoa, {"time_usec": aoa.time_us, **angles})

    def _scaled_pressure(self, baro: RecordTable) -> Columns:
        hectopascal = 0.01 * baro.fields["Press"].astype(np.float64)
        fields: dict[str, ArrayLike] = {"time_boot_ms": _milliseconds(baro.time_us), "press_abs": hectopascal}
        return self._message("SCALED_PRESSURE", baro, fields)

    def _servo_outputs(self) -> Iterator[Columns]:
        """Yield SERVO_OUTPUT_RAW, one for each bank of 16. RCOU has outputs 1 to 14, RCO2 15 to 18, RCO3 19
        to 32."""
        pulses: dict[int, NDArray[Any]] = {}
        if "RCOU" not in self._tables:
            return
        rcou = self._tables["RCOU"]
        for name in ("RCOU", "RCO2", "RCO3"):
            if name in self._tables:
                table = self._tables[name]
                for field, values in table.fields.items():
                    if field[0] == "C" and field[1:].isdigit():
                        # The autopilot writes the output records of one loop one after the other.
                        at = nearest(rcou.time_us, table.time_us)
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

    def _rc_channels(self, rcin: RecordTable) -> Columns:
        pulses: dict[str, ArrayLike] = {
            f"chan{field[1:]}_raw": values
            for field, values in rcin.fields.items()
            if field[0] == "C" and field[1:].isdigit()
        }
        return self._message("RC_CHANNELS", rcin, {"time_boot_ms": _milliseconds(rcin.time_us), **pulses})

    def _vfr_hud(self) -> Iterator[Columns]:
        """Yield the air speed, climb rate and throttle, each at the stamps of its own record."""
        found = air(self._tables, "ARSP" in self._interrupted)
        self._said += found.said
        if found.records:
            fields: dict[str, ArrayLike] = dict(air_data(*found.records))
            order = np.asarray(fields.pop("order"))
            yield self._made("VFR_HUD", order, np.asarray(fields["time_usec"]), fields)

    def _wind(self, estimated: RecordTable) -> Columns:
        """Return WIND: the speed of the estimator's wind, and the direction from which it blows."""
        north, east = (estimated.fields[name].astype(np.float64) for name in ("VWN", "VWE"))
        fields: dict[str, ArrayLike] = {
            "time_usec": estimated.time_us,
            "speed": np.hypot(north, east),
            "direction": np.degrees(np.arctan2(-east, -north)),
        }
        return self._message("WIND", estimated, fields)

    def _global_position_int(self, pos: RecordTable) -> Columns:
        fields: dict[str, ArrayLike] = {
            "time_boot_ms": _milliseconds(pos.time_us),
            "lat": np.round(pos.fields["Lat"] * 1e7).astype(np.int64),
            "lon": np.round(pos.fields["Lng"] * 1e7).astype(np.int64),
            "alt": np.asarray(pos.fields["Alt"] * 1e3, dtype=np.float64),
            "relative_alt": np.asarray(pos.fields["RelHomeAlt"] * 1e3, dtype=np.float64),
        }
        return self._message("GLOBAL_POSITION_INT", pos, fields)

    def _statustext(self) -> Columns:
        """Return the vehicle's own texts, and sentences on choices made in reading the log."""
        msg = self._tables.get("MSG")
        own = [] if msg is None else zip(msg.order, msg.time_us, msg.fields["Message"].tolist(), strict=True)
        # A record's own messages use its order and the next one.
        read = [
            (one.order + 2 + k, one.time_us, READER + one.text.encode()) for k, one in enumerate(self._said)
        ]
        texts = np.array(
            [*own, *lost_texts(self._tables), *read],
            dtype=[("order", "i8"), ("time_us", "i8"), ("text", "S256")],
        )
        fields: dict[str, ArrayLike] = {"severity": _NOT_LOGGED, "text": texts["text"]}
        return self._made("STATUSTEXT", texts["order"], texts["time_us"], fields)


def _milliseconds(time_us: NDArray[np.int64]) -> NDArray[np.int64]:
    return (time_us + 500) // 1000
