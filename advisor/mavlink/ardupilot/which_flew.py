"""Choice of the sensor and estimator with which the autopilot flew, among several in an ArduPilot log.

One row of ``KINDS`` states, for each record, the fields of health and use, the field or record that names the
primary, and the parameters. The names are those of ArduPilot's log messages and parameters.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from advisor.mavlink.ardupilot.sensors import Said
from advisor.mavlink.records.dataflash import RecordTable
from advisor.mavlink.records.equivalent import latest
from advisor.process.arrays import FloatArray


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
