"""A simulator's table (CSV, or MATLAB's MAT) as messages: X-Plane, Simulink, FlightGear's generic protocol.

The aircraft file maps column names to quantities. The columns become messages of a telemetry link, and
manoeuvres are found by the one path of every log.
"""

import csv
from collections.abc import Iterator, Mapping
from dataclasses import fields, replace
from math import degrees
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from advisor.aircraft.aircraft import Aircraft, TableColumns
from advisor.aircraft.controls import Elevator
from advisor.aircraft.sensors import Alpha
from advisor.flight.maneuvers.events import ManeuverFlown
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.flight.signals.messages import Columns, FloatArray
from advisor.flight.stream.stream import FlightStream
from advisor.mavlink.records.equivalent import MAV_TYPE_FIXED_WING, message
from advisor.words.problems import ConfigurationError, UnusableInputError

SUFFIXES = (".csv", ".txt", ".tsv", ".mat")
_SEPARATORS = ",;\t|"
_ANGLES = frozenset({"elevator", "alpha", "q", "theta", "bank", "p", "r"})
_HALF_TURN = ("elevator", "alpha", "theta")
"""Angles that never exceed a quarter of a turn."""
_CENTRE_US, _US_PER_DEG = 1500.0, 10.0
"""Pulse width at zero deflection, and its change per degree, of an arbitrary calibration that is inverted
later."""
_SYSTEM, _ARDUPILOT, _ARMED_MANUAL = 1, 3, 128
_ORDERS = 8
"""Number of messages of one row, which arrive one after another."""


def table_maneuvers(path: Path, aircraft: Aircraft) -> list[Maneuver]:
    """Return the manoeuvres in a simulator's table.

    Raises
    ------
    ConfigurationError
        The aircraft file maps no columns, or a column that the table lacks.
    UnusableInputError
        The file is no table of numbers, its time does not rise, or no manoeuvre can be found.
    """
    if aircraft.columns is None:
        raise ConfigurationError(
            f"log:{path}: the aircraft file names no column of {path.name}: add a section columns: with time,"
            " elevator and q, better also alpha, theta, a_z and airspeed."
        )
    quantities = _quantities(_read(path), aircraft.columns, path.name)
    _refuse_degrees(quantities, aircraft.columns, path.name)
    calibration = tuple((_CENTRE_US + _US_PER_DEG * deg, deg) for deg in (-90.0, 90.0))
    mapped = replace(
        aircraft,
        elevator=replace(Elevator(output=1), calibration=calibration),
        alpha=replace(Alpha(), source="named_value:alpha"),
    )
    stream = FlightStream(mapped)
    events = [*stream.feed(list(_messages(quantities))), *stream.finish()]
    if problems := stream.problems():
        raise UnusableInputError.of(problems)
    return [event.maneuver for event in events if isinstance(event, ManeuverFlown)]


def _quantities(
    table: Mapping[str, FloatArray], columns: TableColumns, file: str
) -> Mapping[str, FloatArray]:
    """Return the mapped quantities in SI units, each of shape (n,)."""
    named = {f.name: getattr(columns, f.name) for f in fields(columns) if f.name not in ("units", "scale")}
    angle = np.radians(1.0) if columns.units == "deg" else 1.0
    found = {}
    for name, column in named.items():
        if column is None:
            continue
        if column not in table:
            raise ConfigurationError(
                f"columns.{name}: {file} has no column {column!r}; it has {', '.join(list(table)[:20])}."
            )
        found[name] = columns.scale.get(name, 1.0) * (angle if name in _ANGLES else 1.0) * table[column]
    t = found["time"]
    if len(t) < 2 or not np.all(np.diff(t) > 0.0):
        raise UnusableInputError(
            "table_time", f"The time of {file} does not rise from row to row.", "Correct columns.time."
        )
    return found


def _refuse_degrees(given: Mapping[str, FloatArray], columns: TableColumns, file: str) -> None:
    """Refuse angles whose values are not in rad."""
    for name in (n for n in _HALF_TURN if n in given):
        largest = float(np.nanmax(np.abs(given[name]), initial=0.0))
        if largest > np.pi / 2.0:
            raise UnusableInputError(
                "table_units",
                f"{file}: {getattr(columns, name)} reaches {largest:.3g}; {name} in rad is below 1.57.",
                "Write columns: {units: deg} in the aircraft file where the table is in degrees.",
            )


def _messages(given: Mapping[str, FloatArray]) -> Iterator[Columns]:
    """Yield the messages that a vehicle with these motions would have sent."""
    t = given["time"] - given["time"][0]
    milliseconds, microseconds = 1e3 * t, 1e6 * t
    rows = np.arange(len(t), dtype=np.int64) * _ORDERS

    def of(name: str, place: int, values: Mapping[str, ArrayLike], which: slice = slice(None)) -> Columns:
        cut = {key: np.asarray(y)[which] if np.ndim(y) else y for key, y in values.items()}
        return message(name, _SYSTEM, rows[which] + place, t[which], cut, "telemetry")

    nothing = np.full(len(t), np.nan)
    every_second = slice(None, None, max(round(1.0 / float(np.median(np.diff(t)))), 1))
    heart = {"type": MAV_TYPE_FIXED_WING, "autopilot": _ARDUPILOT, "base_mode": _ARMED_MANUAL}
    yield of("HEARTBEAT", 0, heart, every_second)
    yield of("ATTITUDE", 1, {
        "time_boot_ms": milliseconds, "pitchspeed": given["q"], "pitch": given.get("theta", nothing),
        "roll": given.get("bank", nothing), "rollspeed": given.get("p", nothing),
        "yawspeed": given.get("r", nothing),
    })  # fmt: skip
    if "alpha" in given:
        names = np.full(len(t), b"alpha", dtype="S10")
        yield of("NAMED_VALUE_FLOAT", 2, {
            "time_boot_ms": milliseconds, "value": given["alpha"], "name": names
        })  # fmt: skip
    if "a_z" in given:
        force = {"zacc": given["a_z"], "xacc": given.get("a_x", nothing)}
        yield of("HIGHRES_IMU", 3, {"time_usec": microseconds, **force})
    speeds = {"true_airspeed": "airspeed", "airspeed": "indicated_airspeed"}
    air = {field: given[name] for field, name in speeds.items() if name in given}
    throttle = 100.0 * given.get("throttle", nothing)
    height = given.get("height", nothing)
    yield of("VFR_HUD", 4, {"time_usec": microseconds, **air, "throttle": throttle, "alt": height})
    pulses = _CENTRE_US + _US_PER_DEG * degrees(1.0) * given["elevator"]
    yield of("SERVO_OUTPUT_RAW", 5, {"time_usec": microseconds, "servo1_raw": pulses})


def _read(path: Path) -> Mapping[str, FloatArray]:
    """Return the columns of a table of numbers by name."""
    try:
        found = _mat(path) if path.suffix.lower() == ".mat" else _text(path)
    except Exception as error:
        # SciPy passes on its own exceptions, of zlib and of struct, down to Exception itself.
        raise UnusableInputError(
            "table", f"{path.name} is no table of numbers: {error}.", "Export it as CSV with a header line."
        ) from error
    if not found:
        raise UnusableInputError(
            "table", f"{path.name} has no column of numbers.", "Export it as CSV with a header line."
        )
    return found


def _text(path: Path) -> Mapping[str, FloatArray]:
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
        head = file.readline()
        separator = max(_SEPARATORS, key=head.count)
        names = [name.strip() for name in next(csv.reader([head.lstrip("#")], delimiter=separator))]
        rows = [row for row in csv.reader(file, delimiter=separator) if len(row) >= len(names)]
    values = np.array([[_number(cell) for cell in row[: len(names)]] for row in rows], dtype=np.float64)
    return {name: column for name, column in zip(names, values.T, strict=False) if name}


def _number(cell: str) -> float:
    try:
        return float(cell)
    except ValueError:
        return np.nan


def _mat(path: Path) -> Mapping[str, FloatArray]:
    """Return the vectors of a MAT file up to version 7, and those inside its structures as ``name.field``."""
    from scipy.io import loadmat

    found: dict[str, FloatArray] = {}

    def take(name: str, value: object) -> None:
        if hasattr(value, "_fieldnames"):
            for field in value._fieldnames:
                take(f"{name}.{field}", getattr(value, field))
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim == 1:
            found[name] = value.astype(np.float64)

    for name, value in loadmat(path, squeeze_me=True, struct_as_record=False).items():
        if not name.startswith("__"):
            take(name, value)
    return found
