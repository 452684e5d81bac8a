"""Identity of an ArduPilot log's vehicle: kind, mode, parameters, version."""

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike

from advisor.mavlink.records.equivalent import MAV_PARAM_TYPE_REAL32, MAV_TYPE_FIXED_WING, system_id
from advisor.mavlink.records.stretches import RecordTable, parameters_in
from advisor.process.arrays import IntArray

VEHICLE_RECORDS: dict[str, set[str]] = {
    "MODE": {"ModeNum"},
    "MSG": {"Message"},
    "PARM": {"Name", "Value"},
    "VER": {"Maj", "Min", "Pat", "FWT"},
}
"""Necessary fields of each record, by the record's name."""
_ARDUPILOTMEGA = 3  # MAV_AUTOPILOT
_BUILD_TO_MAV_TYPE = {1: 10, 2: 2, 3: MAV_TYPE_FIXED_WING, 4: 5, 7: 12, 12: 7, 13: 4}
"""MAV_TYPE of each value of VER.BU: rover, copter, plane, antenna tracker, submarine, airship, helicopter."""
_TITLES = {"ArduPlane": MAV_TYPE_FIXED_WING, "ArduCopter": 2, "ArduRover": 10, "ArduSub": 12}
"""MAV_TYPE of each firmware name in MSG, for logs without VER."""
_STICKS = {"RCMAP_ROLL": (1, 4), "RCMAP_PITCH": (2, 19), "RCMAP_YAW": (4, 21)}
"""Default and present SERVOn_FUNCTION of each stick's output parameter, for old firmware (ArduPlane 3.7)."""
_MIXERS = ("ELEVON_MIXING", "ELEVON_OUTPUT", "VTAIL_OUTPUT")
"""Parameters of old firmware that mix two axes onto one output. The role of each output is then unknown."""


def system_of(tables: Mapping[str, RecordTable]) -> int:
    """Return the system id from its parameter, under the old or the new name."""
    for name, value in parameters_in(tables):
        if name in (b"SYSID_THISMAV", b"MAV_SYSID"):
            return system_id(value)
    return system_id(None)


def heartbeats(tables: Mapping[str, RecordTable]) -> tuple[IntArray, IntArray, dict[str, ArrayLike]]:
    """Return a heartbeat before all other messages, and two heartbeats at each change of mode.

    A log states a change of mode at its time. The first of the two heartbeats states that the earlier mode
    lasted until then. Over a link, with one heartbeat a second, the mode might have ended at any time since
    the last heartbeat.

    Returns
    -------
    order, time_us, fields
    """
    order, modes, time_us = np.zeros(1, np.int64), np.zeros(1, np.int64), np.zeros(1, np.int64)
    if "MODE" in tables:
        mode = tables["MODE"]
        numbers = mode.fields["ModeNum"].astype(np.int64)
        changes = np.column_stack([np.append(numbers[:1], numbers[:-1]), numbers])
        order = np.append(order, np.column_stack([mode.order - 1, mode.order]))
        modes = np.append(numbers[:1], changes)
        time_us = np.append(mode.time_us[:1], np.repeat(mode.time_us, 2))
    fields: dict[str, ArrayLike] = {
        "type": _mav_type(tables),
        "autopilot": _ARDUPILOTMEGA,
        "base_mode": 1,  # custom_mode is in use
        "custom_mode": modes,
        "mavlink_version": 3,
    }
    return order, time_us, fields


def parameter_fields(parm: RecordTable) -> dict[str, ArrayLike]:
    """Return the fields of PARAM_VALUE from the records PARM."""
    return {
        "param_id": parm.fields["Name"],
        "param_value": parm.fields["Value"],
        "param_type": MAV_PARAM_TYPE_REAL32,
        "param_count": len(parm),
        "param_index": np.arange(len(parm)),
    }


def in_todays_parameters(parm: RecordTable) -> RecordTable:
    """Return the parameters under present names, also from firmware older than SERVOn_FUNCTION."""
    names = [bytes(name) for name in parm.fields["Name"].tolist()]
    if any(name.startswith(b"SERVO") and name.endswith(b"_FUNCTION") for name in names):
        return parm
    stored = dict(zip((name.decode("ascii", "replace") for name in names), parm.fields["Value"], strict=True))
    if "RC2_TRIM" not in stored:
        return parm
    renamed = [_today(name) for name in names]
    values = parm.fields["Value"].astype(np.float64)
    turned = [name.endswith(b"_REV") for name in names]
    values[turned] = values[turned] < 0.0  # RCn_REV is 1 or -1, SERVOn_REVERSED 0 or 1
    functions = {} if any(stored.get(mixer, 0.0) for mixer in _MIXERS) else _stick_functions(stored)
    n, extra = len(parm), len(functions)
    return RecordTable(
        np.concatenate([parm.order, parm.order[-1] + 1 + np.arange(extra)]),
        {
            "TimeUS": np.concatenate([parm.time_us, np.full(extra, parm.time_us[-1])]),
            "Name": np.array([*renamed, *functions], dtype="S16"),
            "Value": np.concatenate([values[:n], list(functions.values())]),
        },
    )


def _today(name: bytes) -> bytes:
    output, _, what = name.partition(b"_")
    today = {b"MIN": b"MIN", b"MAX": b"MAX", b"TRIM": b"TRIM", b"REV": b"REVERSED", b"FUNCTION": b"FUNCTION"}
    if output[:2] != b"RC" or not output[2:].isdigit() or what not in today:
        return name
    return b"SERVO" + output[2:] + b"_" + today[what]


def _stick_functions(stored: Mapping[str, float]) -> dict[bytes, float]:
    return {
        f"SERVO{int(stored.get(parameter, output))}_FUNCTION".encode(): float(function)
        for parameter, (output, function) in _STICKS.items()
    }


def version_fields(ver: RecordTable) -> dict[str, ArrayLike]:
    """Return the fields of AUTOPILOT_VERSION from the records VER."""
    major, minor, patch, kind = (ver.fields[name].astype(np.int64) for name in ("Maj", "Min", "Pat", "FWT"))
    return {"flight_sw_version": major << 24 | minor << 16 | patch << 8 | kind}


def _mav_type(tables: Mapping[str, RecordTable]) -> int:
    ver, msg = tables.get("VER"), tables.get("MSG")
    if ver is not None and "BU" in ver.fields:
        return _BUILD_TO_MAV_TYPE.get(int(ver.fields["BU"][0]), MAV_TYPE_FIXED_WING)
    for text in msg.fields["Message"].tolist() if msg is not None else ():
        for title, kind in _TITLES.items():
            if text.startswith(title.encode()):
                return kind
    return MAV_TYPE_FIXED_WING
