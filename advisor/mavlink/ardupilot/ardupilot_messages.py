"""Conversion of an ArduPilot log's records to the messages that its telemetry would have carried.

One row of ``KINDS`` states, for each record, the fields of health and use, the field or record that names the
primary, and the parameters. The names are those of ArduPilot's log messages and parameters.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.flight.signals.messages import Columns
from advisor.flight.stream.identity import READER
from advisor.mavlink.ardupilot.ardupilot_vehicle import (
    heartbeats,
    in_todays_parameters,
    parameter_fields,
    system_of,
    version_fields,
)
from advisor.mavlink.ardupilot.body_rates import RATE_RECORDS, body_rates, calmed
from advisor.mavlink.ardupilot.former_records import Clocked
from advisor.mavlink.ardupilot.log_health import health, lost_texts, sweeps
from advisor.mavlink.ardupilot.sensors import Said, Silence, changes, flown, said, silences_in, stated_health
from advisor.mavlink.records.equivalent import air_data, latest, message, milliseconds, nearest, side_by_side
from advisor.mavlink.records.stretches import RecordTable, gps_time_base_s, seconds
from advisor.process.arrays import FloatArray, IntArray


@dataclass(frozen=True, slots=True)
class Kind:
    """Fields and parameters with which a log states the instance of a record that the autopilot used."""

    quantity: str
    """Measured quantity, for sentences; empty if the sentence about another record names the instance."""
    noun: str = "sensor"
    primary_field: str = ""
    """Field of the record with the number of the primary instance."""
    selector: tuple[str, str] = ("", "")
    """Another record, and its field with the number of the primary instance."""
    primary_parameters: tuple[str, ...] = ()
    """Parameters with the number of the primary instance, the present name first."""
    use_parameters: tuple[str, ...] = ()
    """Parameter of each instance that is 0 if the instance is not used."""
    needs_health: bool = True
    """Whether a time without a healthy instance is reported."""


_LANES_3, _LANES_2 = ("XKF4", "PI"), ("NKF4", "PI")
_INS_USE = ("INS_USE", "INS_USE2", "INS_USE3")
KINDS: Mapping[str, Kind] = {
    "ARSP": Kind("Air speed", primary_field="Pri", primary_parameters=("ARSPD_PRIMARY",)),
    "IMU": Kind("Angular rates and specific force", use_parameters=_INS_USE),
    "GYR": Kind("Angular rates", use_parameters=_INS_USE),
    "ACC": Kind("Specific force", use_parameters=_INS_USE),
    "BARO": Kind("Static pressure", primary_parameters=("BARO_PRIMARY", "GND_PRIMARY"), needs_health=False),
    "GPS": Kind("GPS", "receiver", needs_health=False),
    "XKF1": Kind("EKF3", "lane", selector=_LANES_3),
    "XKF2": Kind("", "lane", selector=_LANES_3),
    "NKF1": Kind("EKF2", "lane", selector=_LANES_2),
    "NKF2": Kind("", "lane", selector=_LANES_2),
}
"""Records of which a log may have several instances, by name."""
SELECTORS: Mapping[str, set[str]] = {record: {field} for record, field in (_LANES_3, _LANES_2)}
"""Necessary fields of the records that name a primary instance, by the record's name."""
FAMILIES = {2: "NKF", 3: "XKF"}
"""Begin of the records of each estimator, by the value of AHRS_EKF_TYPE."""


def named_primary(kind: Kind, table: RecordTable, tables: Mapping[str, RecordTable]) -> FloatArray:
    """Return the number of the primary instance at each record, shape (n,); NaN if the log names
    no instance.
    """
    name, field = kind.selector
    if name in tables and field in tables[name].fields and len(tables[name]):
        stated = tables[name]
        values = stated.fields[field].astype(np.float64)
        at = latest(table.order, stated.order, values)
        return np.where(np.isnan(at), values[0], at)
    if kind.primary_field in table.fields:
        return table.fields[kind.primary_field].astype(np.float64)
    for parameter in kind.primary_parameters:
        value = parameter_value(tables, parameter)
        if value is not None:
            return np.full(len(table), value)
    return np.full(len(table), np.nan)


def unused(kind: Kind, tables: Mapping[str, RecordTable]) -> Collection[int]:
    """Return the numbers of the instances that the parameters exclude."""
    return {k for k, name in enumerate(kind.use_parameters) if parameter_value(tables, name) == 0.0}


def families(tables: Mapping[str, RecordTable]) -> tuple[str, ...]:
    """Return the records of the estimators by the begin of their names; the estimator in use comes first."""
    stated = parameter_value(tables, "AHRS_EKF_TYPE")
    flew = FAMILIES.get(int(stated)) if stated is not None else None
    return tuple(dict.fromkeys((*((flew,) if flew else ()), "XKF", "NKF", "EKF")))


def said_family(tables: Mapping[str, RecordTable]) -> list[Said]:
    """Return a sentence if a log holds several estimators, and the autopilot did not use the newest."""
    first = families(tables)[0]
    if first == "XKF" or not {f"{first}1", "XKF1"} <= tables.keys():
        return []
    table = tables[f"{first}1"]
    text = "Estimator: EKF2 flew (AHRS_EKF_TYPE 2), and EKF3 ran beside it"
    return [Said(int(table.order[0]), int(table.time_us[0]), text)]


def parameter_value(tables: Mapping[str, RecordTable], name: str) -> float | None:
    """Return the last value of a parameter in the log; None if the log does not state it."""
    if "PARM" not in tables:
        return None
    fields = tables["PARM"].fields
    rows = np.flatnonzero(fields["Name"] == name.encode())
    return float(fields["Value"][rows[-1]]) if len(rows) else None


_AIR_SPEED = {"ARSP": "Airspeed", "CTUN": "As", "NTUN": "Arspd"}
"""Field with the air speed of each record, the best record first."""


@dataclass(frozen=True, slots=True)
class AirRecords:
    """Air data of a log, and the sentences about their sources."""

    records: list[dict[str, NDArray[Any]]]
    """Order of arrival, stamps in us and values of one field, each of shape (n,)."""
    said: list[Said]


def air(tables: Mapping[str, RecordTable], interrupted: bool) -> AirRecords:
    """Return the air data in the records of a log.

    Parameters
    ----------
    tables
        Records by name. Each holds only the sensor or estimator in use.
    interrupted
        Whether at some times no air speed sensor was healthy.
    """
    speed, said = _airspeed(tables, interrupted)
    descent = _first(tables, [(f"{family}1", "VD") for family in families(tables)])
    climb = _first(tables, [("BARO", "CRt")]) if descent is None else (descent[0], -descent[1])
    by_field = {"climb": climb, "throttle": _first(tables, [("CTUN", "ThO")])}
    others = [
        # The orders of one record are consecutive: CTUN may hold air speed and throttle.
        {"order": series[0].order + place, "time_usec": series[0].time_us, field: series[1]}
        for place, (field, series) in enumerate(by_field.items(), start=2)
        if series is not None
    ]
    return AirRecords([*speed, *others], said)


def _airspeed(
    tables: Mapping[str, RecordTable], interrupted: bool
) -> tuple[list[dict[str, NDArray[Any]]], list[Said]]:
    """Return the air speed from the best record, and from the next record while no sensor was healthy."""
    sources = [
        (tables[name], field)
        for name, field in _AIR_SPEED.items()
        if name in tables and field in tables[name].fields
    ]
    if not sources:
        return [], []
    (best, field), *spare = sources
    order, time_us, speed = best.order, best.time_us, best.fields[field].astype(np.float64)
    said = []
    if interrupted and spare:
        # The autopilot's own air speed goes on without a sensor.
        stand_in, spare_field = spare[0]
        rows = _away_from(time_us, stand_in.time_us)
        if rows.any():
            text = f"Air speed: {spare_field} of the autopilot replaces the sensor while none is healthy"
            said.append(Said(int(stand_in.order[rows][0]), int(stand_in.time_us[rows][0]), text))
        order = np.concatenate([order, stand_in.order[rows]])
        time_us = np.concatenate([time_us, stand_in.time_us[rows]])
        speed = np.concatenate([speed, stand_in.fields[spare_field][rows]])
    return [{"order": order + 1, "time_usec": time_us, "airspeed": speed}], said


def _first(
    tables: Mapping[str, RecordTable], places: Iterable[tuple[str, str]]
) -> tuple[RecordTable, FloatArray] | None:
    """Return the first record that has the named field, with the field's values; None without one."""
    for name, key in places:
        if name in tables and key in tables[name].fields:
            table = tables[name]
            return table, table.fields[key].astype(np.float64)
    return None


def _away_from(time_us: IntArray, other_us: IntArray) -> NDArray[np.bool_]:
    """Return whether each of the other times is more than three sampling intervals away from all
    ``times``.
    """
    if len(time_us) < 2:
        return np.ones(len(other_us), dtype=np.bool_)
    apart_us = np.abs(other_us - time_us[nearest(other_us, time_us)])
    far: NDArray[np.bool_] = apart_us > 3.0 * float(np.median(np.diff(time_us)))
    return far


_NOT_LOGGED = 255
"""MAV_SEVERITY that each text of MSG gets, because MSG does not keep the severity (0 to 7)."""


@dataclass(frozen=True, slots=True)
class Known:
    """Facts about a whole log from its earlier stretches; None before the first stretch."""

    epoch_s: int | None = None
    """Seconds since 1970 at TimeUS 0 of a log that counted from 1970, else 0."""
    base_s: float | None = None
    """Time of boot, seconds since 1970; 0 if the log does not state it."""
    health: Mapping[str, set[str]] = field(default_factory=dict)
    """Fields that have stated a sensor as healthy, by the sensor's record."""
    silences: Mapping[str, list[Silence]] = field(default_factory=dict)
    """Times without a healthy sensor in the newest stretch, by the sensor's record."""


class Translation:
    """Conversion of the records in one stretch of a log."""

    def __init__(self, read: Clocked, facts: Known) -> None:
        self._tables = dict(read.tables)
        self._said: list[Said] = []
        if read.epoch_s:
            self._said.append(Said(0, 0, "Stamps count from 1970, so times are given since the first record"))
        healthy: dict[str, set[str]] = dict(facts.health)
        silences: dict[str, list[Silence]] = {}
        for name, kind in KINDS.items():
            if name in self._tables:
                every = self._tables[name]
                healthy[name] = stated_health(every) | healthy.get(name, set())
                primary, excluded = named_primary(kind, every, read.tables), unused(kind, read.tables)
                table = self._tables[name] = flown(every, healthy[name], primary, excluded)
                if not kind.needs_health:
                    self._said += changes(table, kind.quantity, kind.noun)
                elif kind.quantity:
                    silences[name] = silences_in(every, table, facts.silences.get(name, []))
                    self._said += said(every, table, kind.quantity, healthy[name], silences[name], kind.noun)
        self._said += said_family(self._tables)
        self._tables = {name: table for name, table in self._tables.items() if len(table)}
        if "PARM" in self._tables:
            self._tables["PARM"] = in_todays_parameters(self._tables["PARM"])
        self._said += [*health(read.tables), *sweeps(self._tables)]
        first_s = float(read.epoch_s) or gps_time_base_s(read.tables.get("GPS"))
        self._base_s = first_s if facts.base_s is None else facts.base_s
        self.facts = Known(read.epoch_s, self._base_s, healthy, silences)
        """Facts of the whole log after this stretch."""
        self._system = system_of(self._tables)

    def columns(self) -> Iterator[Columns]:
        """Yield the messages of each type. Records that no later message needs are dropped during the
        conversion."""
        order, time_us, fields = heartbeats(self._tables)
        yield self._made("HEARTBEAT", order, time_us, fields)
        yield from self._attitude()
        yield from self._highres_imu()
        self._drop("ATT", "IMU", "ACC", *RATE_RECORDS)
        translations = {
            "AOA": self._aoa_ssa,
            "NVAL": self._named_value_float,
            "NVF": self._named_value_float,
            "POS": self._global_position_int,
            "RCIN": self._rc_channels,
        }
        for name, translate in translations.items():
            if name in self._tables:
                yield translate(self._tables.pop(name))
        if "GPS" in self._tables and "Alt" in self._tables["GPS"].fields:
            gps = self._tables["GPS"]
            yield self._message("GPS_RAW_INT", gps, {"alt": 1e3 * gps.fields["Alt"].astype(np.float64)})
        if "PARM" in self._tables:
            yield self._message("PARAM_VALUE", self._tables["PARM"], parameter_fields(self._tables["PARM"]))
        if "VER" in self._tables:
            yield self._message("AUTOPILOT_VERSION", self._tables["VER"], version_fields(self._tables["VER"]))
        if "BARO" in self._tables and "Press" in self._tables["BARO"].fields:
            yield self._scaled_pressure(self._tables["BARO"])
        yield from self._servo_outputs()
        self._drop("RCOU", "RCO2", "RCO3")
        yield from self._vfr_hud()
        winds = (f"{family}2" for family in families(self._tables))
        blown = next((self._tables[name] for name in winds if name in self._tables), None)
        if blown is not None:
            yield self._wind(blown)
        yield self._statustext()

    def _drop(self, *names: str) -> None:
        for name in names:
            self._tables.pop(name, None)

    def _message(
        self, name: str, table: RecordTable, fields: dict[str, ArrayLike], place: int = 0
    ) -> Columns:
        """Return one message for each row of a record. ``place`` keeps a row's messages in order."""
        return self._made(name, table.order + place, table.time_us, fields)

    def _made(self, name: str, order: IntArray, time_us: IntArray, fields: dict[str, ArrayLike]) -> Columns:
        arrival_s = self._base_s + seconds(time_us)
        return message(name, self._system, order, arrival_s, fields, "dataflash")

    def _attitude(self) -> Iterator[Columns]:
        """Yield angles at the stamps of ATT, and rates at the stamps of their own records."""
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
            yield self._made("ATTITUDE", order, time_us, fields | {"time_boot_ms": milliseconds(time_us)})

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

    def _named_value_float(self, named: RecordTable) -> Columns:
        """Return the values of NVAL (received from another system) or of NVF (sent by a script)."""
        fields: dict[str, ArrayLike] = {"time_boot_ms": milliseconds(named.time_us)}
        fields |= {"name": named.fields["Name"], "value": named.fields["Value"]}
        return self._message("NAMED_VALUE_FLOAT", named, fields)

    def _scaled_pressure(self, baro: RecordTable) -> Columns:
        hectopascal = 0.01 * baro.fields["Press"].astype(np.float64)
        fields: dict[str, ArrayLike] = {"time_boot_ms": milliseconds(baro.time_us), "press_abs": hectopascal}
        return self._message("SCALED_PRESSURE", baro, fields)

    def _servo_outputs(self) -> Iterator[Columns]:
        """Yield SERVO_OUTPUT_RAW, one for each bank of 16. RCOU has 1 to 14, RCO2 15 to 18, RCO3 19 to 32."""
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
        return self._message("RC_CHANNELS", rcin, {"time_boot_ms": milliseconds(rcin.time_us), **pulses})

    def _vfr_hud(self) -> Iterator[Columns]:
        """Yield air speed, climb rate and throttle, each at the stamps of its own record."""
        measured = air(self._tables, bool(self.facts.silences.get("ARSP")))
        self._said += measured.said
        if measured.records:
            fields: dict[str, ArrayLike] = dict(air_data(*measured.records))
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
            "time_boot_ms": milliseconds(pos.time_us),
            "lat": np.round(pos.fields["Lat"] * 1e7).astype(np.int64),
            "lon": np.round(pos.fields["Lng"] * 1e7).astype(np.int64),
            "alt": np.asarray(pos.fields["Alt"] * 1e3, dtype=np.float64),
            "relative_alt": np.asarray(pos.fields["RelHomeAlt"] * 1e3, dtype=np.float64),
        }
        return self._message("GLOBAL_POSITION_INT", pos, fields)

    def _statustext(self) -> Columns:
        """Return the vehicle's own texts, and sentences about choices during the reading of the log."""
        msg = self._tables.get("MSG")
        own = [] if msg is None else zip(msg.order, msg.time_us, msg.fields["Message"].tolist(), strict=True)
        # A record's own messages use its order and the next one.
        read = [(s.order + 2 + k, s.time_us, READER + s.text.encode()) for k, s in enumerate(self._said)]
        texts = np.array(
            [*own, *lost_texts(self._tables), *read],
            dtype=[("order", "i8"), ("time_us", "i8"), ("text", "S256")],
        )
        fields: dict[str, ArrayLike] = {"severity": _NOT_LOGGED, "text": texts["text"]}
        return self._made("STATUSTEXT", texts["order"], texts["time_us"], fields)
