"""Tables as logs (CSV, or MATLAB's MAT up to version 7): names of columns with units, quantities, and
messages.
"""

import csv
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, fields, replace
from math import degrees
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from advisor.aircraft.aircraft import Aircraft, TableColumns
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import Columns
from advisor.mavlink.logs.formats import LogFormat
from advisor.mavlink.records.equivalent import MAV_TYPE_FIXED_WING, message
from advisor.process.arrays import FloatArray
from advisor.words.problems import ConfigurationError, Problem, UnusableInputError

NAMES: Mapping[str, str] = {
    "time": "time t timestamp seconds elapsed t_boot time_boot",
    "elevator": "elevator de delta_e elev dele ele",
    "aileron": "aileron da delta_a ail dela",
    "rudder": "rudder dr delta_r rud delr",
    "q": "q pitch_rate pitchspeed pitchrate",
    "p": "p roll_rate rollspeed rollrate",
    "r": "r yaw_rate yawspeed yawrate",
    "alpha": "alpha aoa alfa angle_of_attack",
    "beta": "beta ssa aos sideslip angle_of_sideslip",
    "theta": "theta pitch pitch_angle",
    "bank": "bank phi roll bank_angle roll_angle",
    "a_x": "a_x ax accx acc_x xacc",
    "a_y": "a_y ay accy acc_y yacc",
    "a_z": "a_z az accz acc_z zacc",
    "airspeed": "airspeed tas true_airspeed vtas v vt ktas",
    "indicated_airspeed": "indicated_airspeed ias cas eas kias kcas keas",
    "height": "height alt altitude h alt_msl",
    "climb_rate": "climb_rate climb vertical_speed",
    "throttle": "throttle thr",
}
"""Usual names of each quantity in small letters, by the quantity's key in the section ``columns``."""
LOADS: Mapping[str, tuple[str, float]] = {
    "nx": ("a_x", GRAVITY_M_S2), "ny": ("a_y", GRAVITY_M_S2), "nz": ("a_z", -GRAVITY_M_S2)
}  # fmt: skip
"""Quantity of each load factor, with the factor to m/s². A normal load factor is positive upward."""
ANGLES = frozenset({"elevator", "aileron", "rudder", "alpha", "beta", "theta", "bank"})
RATES = frozenset({"q", "p", "r"})
_DEG = 0.017453292519943295
_KNOT, _FOOT, _KM_H = 0.514444, 0.3048, 1.0 / 3.6
_ANGLE = {"rad": 1.0, "deg": _DEG, "degrees": _DEG}
_RATE = {
    "rad_s": 1.0, "rads": 1.0, "radps": 1.0, "rad": 1.0, "deg_s": _DEG, "degs": _DEG, "dps": _DEG, "deg": _DEG
}  # fmt: skip
_SPEED = {
    "m_s": 1.0, "mps": 1.0, "ms": 1.0, "kt": _KNOT, "kts": _KNOT, "knots": _KNOT, "km_h": _KM_H, "kmh": _KM_H,
    "ft_s": _FOOT, "fps": _FOOT,
}  # fmt: skip
_FORCE = {"m_s2": 1.0, "mss": 1.0, "m_ss": 1.0, "g": GRAVITY_M_S2, "ft_s2": _FOOT}
UNITS: Mapping[str, Mapping[str, float]] = {
    "time": {"s": 1.0, "sec": 1.0, "seconds": 1.0, "ms": 1e-3, "us": 1e-6},
    **dict.fromkeys(ANGLES, _ANGLE),
    **dict.fromkeys(RATES, _RATE),
    **dict.fromkeys(("a_x", "a_y", "a_z"), _FORCE),
    **dict.fromkeys(("airspeed", "indicated_airspeed", "climb_rate"), _SPEED),
    "height": {"m": 1.0, "ft": _FOOT, "feet": _FOOT},
    "throttle": {"percent": 0.01, "pct": 0.01, "1": 1.0},
}
"""Factor from a unit to SI, by quantity and by the end of a column's name."""
_KNOTS_IN_NAME = frozenset({"ktas", "kias", "kcas", "keas"})


@dataclass(frozen=True, slots=True)
class NamedColumn:
    """A column of a table whose name says its quantity."""

    column: str
    factor: float | None
    """Factor from the column to SI; None for a name without a unit."""


def plain_name(column: str) -> str:
    """Return a name in small letters with single underscores: ``Alpha [deg]`` becomes ``alpha_deg``.

    Only the last part of a name with dots counts, which is the field of a structure.
    """
    return re.sub(r"[^a-z0-9]+", "_", column.rsplit(".", 1)[-1].lower()).strip("_")


def unit_of(quantity: str, column: str) -> float | None:
    """Return the factor of the unit at the end of a column's name; None for a name without a unit."""
    name = plain_name(column)
    fits = [unit for unit in UNITS[quantity] if name.endswith(f"_{unit}")]
    if fits:
        return UNITS[quantity][max(fits, key=len)]
    return _KNOT if name in _KNOTS_IN_NAME else None


def recognised_columns(columns: Iterable[str]) -> dict[str, NamedColumn]:
    """Return the columns that usual names identify, by quantity. The first of two equal names counts."""
    by_quantity: dict[str, NamedColumn] = {}
    for column in columns:
        for quantity, names in NAMES.items():
            stem = _without_unit(quantity, plain_name(column))
            if stem in names.split() and quantity not in by_quantity:
                by_quantity[quantity] = NamedColumn(column, unit_of(quantity, column))
        load = LOADS.get(plain_name(column).removesuffix("_g"))
        if load is not None:
            by_quantity.setdefault(load[0], NamedColumn(column, load[1]))
    return by_quantity


def _without_unit(quantity: str, name: str) -> str:
    fits = [unit for unit in UNITS[quantity] if name.endswith(f"_{unit}")]
    return name.removesuffix(f"_{max(fits, key=len)}") if fits else name


def is_flight(columns: Iterable[str]) -> bool:
    """Return whether the names of columns include a time, an angular rate and a control surface."""
    keys = recognised_columns(columns).keys()
    return "time" in keys and bool(keys & RATES) and bool(keys & {"elevator", "aileron", "rudder"})


_HALF_TURN = ("elevator", "aileron", "rudder", "alpha", "beta", "theta")
"""Angles that never exceed a quarter of a turn, so that larger values cannot be in rad."""
_SHOWN = 20
"""Largest number of a table's columns that a sentence lists."""


def quantities_of(
    table: Mapping[str, FloatArray], columns: TableColumns, file: str
) -> Mapping[str, FloatArray]:
    """Return the quantities of a table in SI units by their keys in the section ``columns``, shape (n,) each.

    A name of the aircraft file counts before a usual name. The unit at the end of a column's name counts
    before ``units``, unless ``scale`` has the quantity.

    Raises
    ------
    ConfigurationError
        The aircraft file names a column that the table lacks.
    UnusableInputError
        Time, rate or surface is missing, the time does not rise, or an angle cannot be in rad.
    """
    table = _one_group(table)
    named = {f.name: getattr(columns, f.name) for f in fields(columns) if f.name not in ("units", "scale")}
    lost = [(key, column) for key, column in named.items() if column is not None and column not in table]
    if lost:
        key, column = lost[0]
        raise ConfigurationError(f"columns.{key}: {file} has no column {column!r}; it has {_listed(table)}.")
    others = [column for column in table if column not in named.values()]
    usual = {key: recognised.column for key, recognised in recognised_columns(others).items()}
    chosen = {key: named.get(key) or usual.get(key) for key in {**named, **usual}}
    quantities = {
        key: _factor(key, column, columns) * table[column]
        for key, column in chosen.items()
        if column is not None and len(table[column]) == len(table[chosen["time"] or column])
    }
    _refuse_missing(quantities, table, file)
    _refuse_degrees(quantities, chosen, file)
    return quantities


def _one_group(table: Mapping[str, FloatArray]) -> Mapping[str, FloatArray]:
    """Return the columns of the only structure of a MAT file that holds a flight; all columns if there is no
    such structure.
    """
    groups: dict[str, dict[str, FloatArray]] = {}
    for name, column in table.items():
        groups.setdefault(name.rpartition(".")[0], {})[name] = column
    flights = [group for group in groups.values() if is_flight(group)]
    return max(flights, key=len) if flights and len(groups) > 1 else table


def _factor(key: str, column: str, columns: TableColumns) -> float:
    is_angle = key in ANGLES or key in RATES
    stated = float(np.radians(1.0)) if is_angle and columns.units == "deg" else 1.0
    if key in columns.scale:
        return columns.scale[key] * stated
    usual = recognised_columns([column]).get(key)
    by_name = unit_of(key, column) if usual is None else usual.factor
    return stated if by_name is None else by_name


def _refuse_missing(values: Mapping[str, FloatArray], table: Mapping[str, FloatArray], file: str) -> None:
    missing = [key for key in ("time",) if key not in values]
    missing += [] if values.keys() & RATES else ["q (or p, r)"]
    missing += [] if values.keys() & {"elevator", "aileron", "rudder"} else ["elevator (or aileron, rudder)"]
    if missing:
        raise UnusableInputError(
            "table_columns",
            f"{file} has no column that is {' and '.join(missing)}; it has {_listed(table)}.",
            "Name its columns in the aircraft file: columns: {time: …, elevator: …, q: …}.",
        )
    t = values["time"]
    if len(t) < 2 or not np.all(np.diff(t) > 0.0):
        raise UnusableInputError(
            "table_time", f"The time of {file} does not rise from row to row.", "Correct columns.time."
        )


def _refuse_degrees(values: Mapping[str, FloatArray], chosen: Mapping[str, str | None], file: str) -> None:
    """Refuse angles whose values are not in rad."""
    for name in (n for n in _HALF_TURN if n in values):
        largest = float(np.nanmax(np.abs(values[name]), initial=0.0))
        if largest > np.pi / 2.0:
            raise UnusableInputError(
                "table_units",
                f"{file}: {chosen[name]} reaches {largest:.3g}; {name} in rad is below 1.57.",
                "Write columns: {units: deg} in the aircraft file where the table is in degrees.",
            )


def _listed(table: Mapping[str, FloatArray]) -> str:
    names = [*list(table)[:_SHOWN], *(["…"] if len(table) > _SHOWN else [])]
    return ", ".join(names)


_CENTRE_US, _US_PER_DEG = 1500.0, 10.0
"""Pulse width at zero deflection, and its change per degree, of an arbitrary calibration that is inverted
later."""
_SYSTEM, _ARDUPILOT, _ARMED_MANUAL = 1, 3, 128
_ORDERS = 8
"""Number of messages of one row, which arrive one after another."""
_OUTPUTS = {"elevator": 1, "aileron": 2, "rudder": 3}
"""Servo output that carries each surface of a table."""
SURFACES = tuple(_OUTPUTS)
"""Surfaces of a table by their keys in the section ``columns``."""
_LATEST_BOOT_S = 1e6
"""Latest first time that counts as a time since power-on, s. Later ones are dates."""


def with_outputs(aircraft: Aircraft, surfaces: tuple[str, ...] = ("elevator",)) -> Aircraft:
    """Return the aircraft with the surfaces of a table as outputs, and with the table's angles.

    Stops, lag, delay, and places of the instruments stay as the aircraft file states them. A source of the
    angle of attack or of the sideslip other than ``auto`` stays, too.
    """
    given = {name: getattr(aircraft, name) for name in surfaces}
    controls = {
        name: replace(control, output=_OUTPUTS[name], calibration=_scaled(control.ends_deg or (-90.0, 90.0)))
        for name, control in given.items()
    }
    if "elevator" in controls:
        controls["elevator"] = replace(controls["elevator"], outputs=())
    own = {"auto", "aoa_ssa"}
    alpha, beta = aircraft.alpha, aircraft.beta
    return replace(
        aircraft,
        **controls,
        alpha=replace(alpha, source="named_value:alpha") if alpha.source in own else alpha,
        beta=replace(beta, source="named_value:beta") if beta.source in own else beta,
    )


def _scaled(ends_deg: tuple[float, float]) -> tuple[tuple[float, float], ...]:
    return tuple((_CENTRE_US + _US_PER_DEG * deg, deg) for deg in ends_deg)


def messages_of(given: Mapping[str, FloatArray], as_stamped: bool) -> Iterator[Columns]:
    """Yield the messages of a table's quantities (SI).

    Parameters
    ----------
    as_stamped
        Whether times stay unchanged, unless they are dates. Otherwise the first time becomes 0.
    """
    begins = float(given["time"][0])
    t = given["time"] - (0.0 if as_stamped and 0.0 <= begins <= _LATEST_BOOT_S else begins)
    milliseconds, microseconds = 1e3 * t, 1e6 * t
    rows = np.arange(len(t), dtype=np.int64) * _ORDERS
    nothing = np.full(len(t), np.nan)

    def of(name: str, place: int, values: Mapping[str, ArrayLike], which: slice = slice(None)) -> Columns:
        cut = {key: np.asarray(y)[which] if np.ndim(y) else y for key, y in values.items()}
        return message(name, _SYSTEM, rows[which] + place, t[which], cut, "table")

    def get(name: str) -> FloatArray:
        return given.get(name, nothing)

    every_second = slice(None, None, max(round(1.0 / float(np.median(np.diff(t)))), 1))
    heart = {"type": MAV_TYPE_FIXED_WING, "autopilot": _ARDUPILOT, "base_mode": _ARMED_MANUAL}
    yield of("HEARTBEAT", 0, heart, every_second)
    yield of("ATTITUDE", 1, {
        "time_boot_ms": milliseconds, "pitchspeed": get("q"), "pitch": get("theta"), "roll": get("bank"),
        "rollspeed": get("p"), "yawspeed": get("r"),
    })  # fmt: skip
    for place, angle in ((2, "alpha"), (6, "beta")):
        if angle in given:
            names = np.full(len(t), angle.encode(), dtype="S10")
            values = {"time_boot_ms": milliseconds, "value": given[angle], "name": names}
            yield of("NAMED_VALUE_FLOAT", place, values)
    if given.keys() & {"a_z", "a_y"}:
        force = {"xacc": get("a_x"), "yacc": get("a_y"), "zacc": get("a_z")}
        yield of("HIGHRES_IMU", 3, {"time_usec": microseconds, **force})
    speeds = {"true_airspeed": "airspeed", "airspeed": "indicated_airspeed", "climb": "climb_rate"}
    air = {field: given[name] for field, name in speeds.items() if name in given}
    throttle, height = 100.0 * get("throttle"), get("height")
    yield of("VFR_HUD", 4, {"time_usec": microseconds, **air, "throttle": throttle, "alt": height})
    pulses = {
        f"servo{output}_raw": _CENTRE_US + _US_PER_DEG * degrees(1.0) * given[name]
        for name, output in _OUTPUTS.items()
        if name in given
    }
    yield of("SERVO_OUTPUT_RAW", 5, {"time_usec": microseconds, **pulses})


MAT_5 = b"MATLAB 5.0 MAT-file"
"""First bytes of a MAT file that SciPy reads."""
SEPARATORS = ",;\t|"
_FIX = "Export it as CSV with a header line."


def read_table(path: Path) -> Mapping[str, FloatArray]:
    """Return the columns of a table of numbers by name, shape (n,) each; a cell that is no number is NaN.

    Raises
    ------
    UnusableInputError
        The file is no table of numbers.
    """
    try:
        with path.open("rb") as file:
            is_mat = file.read(len(MAT_5)) == MAT_5 or path.suffix.lower() == ".mat"
        columns = _mat(path) if is_mat else _text(path)
    except Exception as error:
        # SciPy passes on its own exceptions, of zlib and of struct, down to Exception itself.
        raise UnusableInputError("table", f"{path.name} is no table of numbers, or damaged.", _FIX) from error
    if not columns:
        raise UnusableInputError("table", f"{path.name} has no column of numbers.", _FIX)
    return columns


def head_of(line: str) -> list[str]:
    """Return the names in the first line of a text table."""
    separator = max(SEPARATORS, key=line.count)
    return [name.strip() for name in next(csv.reader([line.lstrip("#")], delimiter=separator), [])]


def _text(path: Path) -> Mapping[str, FloatArray]:
    with path.open(newline="", encoding="utf-8-sig", errors="replace") as file:
        head = file.readline()
        separator, names = max(SEPARATORS, key=head.count), head_of(head)
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

    columns: dict[str, FloatArray] = {}

    def take(name: str, value: object) -> None:
        if hasattr(value, "_fieldnames"):
            for field in value._fieldnames:
                take(f"{name}.{field}", getattr(value, field))
        elif isinstance(value, np.ndarray) and value.dtype.kind in "fiu" and value.ndim == 1:
            columns[name] = value.astype(np.float64)

    for name, value in loadmat(path, squeeze_me=True, struct_as_record=False).items():
        if not name.startswith("__"):
            take(name, value)
    return columns


_LONGEST_HEAD = 65_536
"""Largest length of a header line, bytes: some thousand names."""
_LEAST_NAMES = 3
"""Least number of columns of a flight: time, rate, surface."""


def _begins_at(beginning: bytes) -> int | None:
    """Return 0 for a MAT file, and for text whose first line is at least three names."""
    if beginning.startswith(MAT_5):
        return 0
    head, newline, _ = beginning[:_LONGEST_HEAD].partition(b"\n")
    if not newline:
        return None
    try:
        line = head.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None
    if not line.strip().replace("\t", " ").isprintable():
        return None
    names = head_of(line.strip())
    named = [name for name in names if any(map(str.isalpha, plain_name(name)))]
    return 0 if len(names) >= _LEAST_NAMES and len(named) == len(names) else None


def _mat_7_3(name: str, beginning: bytes) -> Problem | None:
    if not beginning.startswith((b"MATLAB 7.3 MAT-file", b"\x89HDF\r\n")):
        return None
    text = f"{name} is HDF5, such as a MAT file of version 7.3."
    return Problem("hdf5", text, "In MATLAB save it again with: save('flight.mat', '-v7').")


def _read(path: Path, columns: TableColumns) -> Iterator[list[Columns]]:
    given = quantities_of(read_table(path), columns, path.name)
    yield list(messages_of(given, as_stamped=True))


FORMAT = LogFormat(
    holds="columns of a flight",
    given="a table with named columns (.csv, .mat)",
    ending=".csv",
    begins_at=_begins_at,
    read=lambda path, wanted, starts_at, scanner: _read(path, TableColumns()),
    refusal=_mat_7_3,
    read_columns=_read,
)
