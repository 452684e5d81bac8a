"""ArduPilot's own log (``.bin``, "dataflash"): self-describing binary records.

A record is two bytes of header, a type, and the fields that the type's FMT record lists (ArduPilot:
AP_Logger, "Log message formats").
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.mavlink.records.record_scan import FMT, FMT_LENGTH, HEADER
from advisor.process.arrays import FloatArray, IntArray

_DEFINITION = HEADER + bytes([FMT])
DEFINITION_LAYOUT = np.dtype(
    [("type", "u1"), ("length", "u1"), ("name", "S4"), ("format", "S16"), ("columns", "S64")]
)

# Format character to dtype, and to the divisor of a scaled integer.
_FORMATS: dict[str, tuple[Any, float | None]] = {
    "a": (("<i2", (32,)), None),
    "b": ("i1", None),
    "B": ("u1", None),
    "g": ("<f2", None),
    "h": ("<i2", None),
    "H": ("<u2", None),
    "i": ("<i4", None),
    "I": ("<u4", None),
    "f": ("<f4", None),
    "d": ("<f8", None),
    "n": ("S4", None),
    "N": ("S16", None),
    "Z": ("S64", None),
    "c": ("<i2", 100.0),
    "C": ("<u2", 100.0),
    "e": ("<i4", 100.0),
    "E": ("<u4", 100.0),
    "L": ("<i4", 1e7),
    "M": ("u1", None),
    "q": ("<i8", None),
    "Q": ("<u8", None),
}


@dataclass(frozen=True, slots=True)
class RecordTable:
    """All records of one type, in the order of the file."""

    order: IntArray
    """Shape (n,): position of each record in the file, bytes."""
    fields: dict[str, NDArray[Any]]
    """Values of each field, shape (n,), in the units of the log, by the field's name."""

    def __len__(self) -> int:
        return len(self.order)

    @property
    def time_us(self) -> IntArray:
        """Time stamps, shape (n,), microseconds since boot."""
        return np.asarray(self.fields["TimeUS"], dtype=np.int64)

    def __getitem__(self, rows: NDArray[Any]) -> "RecordTable":
        return RecordTable(self.order[rows], {name: values[rows] for name, values in self.fields.items()})


def first_definition(beginning: bytes) -> int:
    """Return the position of the first FMT record that another record follows; -1 for none."""
    at = beginning.find(_DEFINITION)
    while at >= 0 and beginning[at + FMT_LENGTH : at + FMT_LENGTH + len(HEADER)] != HEADER:
        at = beginning.find(_DEFINITION, at + 1)
    return at


def gps_time_base_s(gps: RecordTable | None) -> float:
    """Return the time of boot, seconds since 1970, from the first fix with a GPS week; 0 without one."""
    if gps is None:
        return 0.0
    dated = np.flatnonzero(gps.fields["GWk"] > 0)
    if not len(dated):
        return 0.0
    i = dated[0]
    gps_epoch, leap_seconds = 315_964_800, 18
    week, in_week_s = int(gps.fields["GWk"][i]), int(gps.fields["GMS"][i]) / 1000
    return gps_epoch + 604_800 * week + in_week_s - leap_seconds - float(gps.time_us[i]) / 1e6


def layout_of(definition: Any) -> tuple["np.dtype[np.void] | None", list[float | None]]:
    """Return the dtype of a type's records, and their fields' divisors; None for an unreadable one."""
    characters = definition["format"].decode("ascii", "replace")
    names = definition["columns"].decode("ascii", "replace").split(",")
    if (
        len(names) != len(characters)
        or len(set(names)) != len(names)
        or not set(characters) <= _FORMATS.keys()
    ):
        return None, []
    specifications = [_FORMATS[character] for character in characters]
    columns = [
        (name, *kind) if isinstance(kind, tuple) else (name, kind)
        for name, (kind, _) in zip(names, specifications, strict=True)
    ]
    layout = np.dtype(columns)
    if layout.itemsize + 3 != definition["length"]:
        return None, []
    return layout, [divisor for _, divisor in specifications]


def seconds(time_us: IntArray) -> FloatArray:
    """Return microseconds as seconds."""
    return time_us.astype(np.float64) * 1e-6


def parameters_in(tables: Mapping[str, RecordTable]) -> list[tuple[bytes, float]]:
    """Return names and values of the records PARM, in order of time."""
    if "PARM" not in tables:
        return []
    fields = tables["PARM"].fields
    return list(zip(fields["Name"].tolist(), fields["Value"].tolist(), strict=True))
