"""Angular rates of an ArduPilot log, from the best record that contains them."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.mavlink.records.stretches import RecordTable
from advisor.process.arrays import FloatArray, IntArray

RATE_RECORDS: dict[str, set[str]] = {
    "GYR": {"GyrX", "GyrY", "GyrZ"},
    "PIDP": {"Act"},
    "RATE": {"R", "P", "Y"},
}
"""Necessary fields of each record with rates, other than IMU. PIDP.Act and RATE are in deg/s (ArduPilot:
AP_PitchController.cpp of every version that logs Act; log messages PIDP and RATE)."""
FASTEST_SAMPLES_HZ = 200.0
"""Largest sampling rate of the angular rates, Hz. Raw gyro records come 1000 times a second and more. Means
over 5 ms keep the short period: at 40 rad/s they lose 0.2 % of its amplitude."""
SLOWEST_ANGLES_HZ = 20.0
"""Least rate of angles, Hz, from which angular rates are derived. The difference over 1/20 s gives the rate
to 1 % for a natural frequency up to 10 rad/s, typical of a small aircraft."""
GYRO_FILTER_HZ = 20.0
"""Value of INS_GYRO_FILTER that is assumed if the log does not state it, Hz: ArduPlane's default.
INS_GYRO_FILTER is the cut-off frequency of a second-order low-pass for all gyro readings."""
_FROZEN_S = 1.0
"""Least time of constant output, s, that shows an inactive controller. An inactive controller keeps its last
rate, as ArduPlane's do in MANUAL."""


@dataclass(frozen=True, slots=True)
class Rates:
    """Angular rates about the body axes, each at its own stamps."""

    order: IntArray
    """Shape (n,): position of each record in the file, bytes."""
    time_us: IntArray
    """Shape (n,): stamps, microseconds since boot."""
    values: FloatArray
    """Shape (3, n): angular rates, rad/s; NaN for an axis that the record lacks."""
    said: str
    """Sentence about the source of the rates, for the user; empty for IMU."""


def body_rates(tables: Mapping[str, RecordTable]) -> Rates | None:
    """Return the rates of IMU, else of GYR, PIDP or RATE, else rates derived from ATT; None without all of
    these.
    """
    if "IMU" in tables:
        return _read(tables["IMU"], ("GyrX", "GyrY", "GyrZ"), 1.0, "")
    if "GYR" in tables:
        return _read(calmed(tables["GYR"]), ("GyrX", "GyrY", "GyrZ"), 1.0, "from GYR")
    if "PIDP" in tables and not _stands_still(tables["PIDP"]):
        return _read(tables["PIDP"], (None, "Act", None), np.pi / 180.0, "from PIDP")
    if "RATE" in tables:
        return _read(tables["RATE"], ("R", "P", "Y"), np.pi / 180.0, "from RATE")
    if "ATT" not in tables:
        return None
    return _from_angles(tables["ATT"], gyro_delay_s(tables.get("PARM")))


def gyro_delay_s(parm: RecordTable | None) -> float:
    """Return the delay of the autopilot's gyro readings at the frequencies of flight, s.

    A second-order Butterworth low-pass delays by √2 / (2π f), with f of INS_GYRO_FILTER. The delay is 11 ms
    at 20 Hz, where a log of ArduPlane 4.5 showed 12 ms (logs/arduplane-calm.tlog).
    """
    corner_hz = GYRO_FILTER_HZ
    if parm is not None:
        stated = parm.fields["Value"][parm.fields["Name"] == b"INS_GYRO_FILTER"]
        corner_hz = float(stated[0]) if len(stated) else corner_hz
    return float(np.sqrt(2.0) / (2.0 * np.pi * corner_hz)) if corner_hz > 0.0 else 0.0


def calmed(table: RecordTable) -> RecordTable:
    """Return the records of a raw sensor, averaged to at most ``FASTEST_SAMPLES_HZ``."""
    steps_us = np.diff(table.time_us)
    many = int(1e6 / FASTEST_SAMPLES_HZ // max(float(np.median(steps_us)), 1.0)) if len(steps_us) else 1
    if many < 2:
        return table
    whole = len(table) // many * many
    fields = {
        name: values[:whole].reshape(-1, many).mean(axis=1)
        for name, values in table.fields.items()
        if values.ndim == 1 and values.dtype.kind in "iuf"
    }
    fields["TimeUS"] = fields["TimeUS"].astype(np.int64)
    return RecordTable(table.order[many - 1 : whole : many], fields)


def _read(
    table: RecordTable, fields: tuple[str | None, str | None, str | None], scale: float, said: str
) -> Rates:
    nothing = np.full(len(table), np.nan)
    rows = [nothing if name is None else scale * table.fields[name].astype(np.float64) for name in fields]
    return Rates(table.order, table.time_us, np.array(rows), said)


def _stands_still(pid: RecordTable) -> bool:
    """Return whether the controller's rate is constant over ``_FROZEN_S`` at any time."""
    moved = np.flatnonzero(np.diff(pid.fields["Act"]) != 0.0) + 1
    edges_us = pid.time_us[np.concatenate(([0], moved, [len(pid) - 1]))]
    return bool(np.max(np.diff(edges_us)) > 1e6 * _FROZEN_S)


def _from_angles(att: RecordTable, delay_s: float) -> Rates | None:
    """Return the rates from differences of the angles, delayed like the gyro's rates."""
    # The angle of attack is late by an equal delay. With undelayed rates, derivatives would be wrong by half.
    t = att.time_us.astype(np.float64) * 1e-6
    step_s = np.diff(t)
    if len(step_s) == 0 or not 0.0 < np.median(step_s) <= 1.0 / SLOWEST_ANGLES_HZ:
        return None
    roll, pitch, yaw = (np.unwrap(np.radians(att.fields[axis])) for axis in ("Roll", "Pitch", "Yaw"))
    near = (step_s > 0.0) & (step_s <= 2.0 / SLOWEST_ANGLES_HZ)
    rows = np.flatnonzero(near)
    d_roll, d_pitch, d_yaw = (np.diff(angle)[rows] / step_s[rows] for angle in (roll, pitch, yaw))
    bank, theta = ((angle[rows] + angle[rows + 1]) / 2 for angle in (roll, pitch))
    values = np.array(
        [
            d_roll - d_yaw * np.sin(theta),
            d_pitch * np.cos(bank) + d_yaw * np.cos(theta) * np.sin(bank),
            d_yaw * np.cos(theta) * np.cos(bank) - d_pitch * np.sin(bank),
        ]
    )
    middle_us = (att.time_us[rows] + att.time_us[rows + 1]) // 2 + round(1e6 * delay_s)
    hz = 1.0 / float(np.median(step_s))
    return Rates(att.order[rows + 1] + 1, middle_us, values, f"derived from the angles of ATT at {hz:.0f} Hz")
