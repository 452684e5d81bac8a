"""Telemetry made with pymavlink, the independent coding these tests compare with."""

import os
import struct
from dataclasses import dataclass
from pathlib import Path

import numpy as np

os.environ["MAVLINK20"] = "1"

from pymavlink import mavutil
from pymavlink.dialects.v20 import ardupilotmega as dialect

from advisor.flight.signals.messages import Columns
from advisor.mavlink.wire.definitions import DEFINITIONS

mavutil.set_dialect("ardupilotmega")

START_US = 1_770_000_000_000_000
"""Stamp of the first record, in the year 2026."""

_INTEGERS = {
    "uint8_t": "u1",
    "int8_t": "i1",
    "uint16_t": "u2",
    "int16_t": "i2",
    "uint32_t": "u4",
    "int32_t": "i4",
    "uint64_t": "u8",
    "int64_t": "i8",
}

REPOSITORY = Path(__file__).parents[2]
LOGS = [
    *sorted((REPOSITORY / "logs").glob("*.tlog")),
    *sorted((REPOSITORY.parent / "shared" / "tlogs").glob("*.tlog")),
]
"""The recorded logs at hand: those of the project, and larger ones beside the checkout."""


class Sender:
    """One system on the link; packs messages into frames and counts them."""

    def __init__(self, system: int = 1, component: int = 1, key: bytes | None = None) -> None:
        self._mav = dialect.MAVLink(None, srcSystem=system, srcComponent=component)
        if key is not None:
            self._mav.signing.secret_key = key
            self._mav.signing.link_id = 1
            self._mav.signing.sign_outgoing = True

    def frame(self, message: dialect.MAVLink_message, version: int = 2) -> bytes:
        frame = bytes(message.pack(self._mav, force_mavlink1=version == 1))
        self._mav.seq = (self._mav.seq + 1) % 256
        return frame

    def set_signing_time(self, stamp: int) -> None:
        self._mav.signing.timestamp = stamp


def record(frame: bytes, stamp_us: int = START_US) -> bytes:
    return struct.pack(">Q", stamp_us) + frame


def random_message(name: str, rng: np.random.Generator) -> dialect.MAVLink_message:
    """A message with values from all over the range of each field, many of them zero."""
    message = dialect.mavlink_map[DEFINITIONS[name].id]
    values = []
    for field, kind in zip(message.fieldnames, message.fieldtypes, strict=True):
        length = message.array_lengths[message.ordered_fieldnames.index(field)]
        values.append(_random_value(kind, length, rng))
    return message(*values)


def _random_value(kind: str, length: int, rng: np.random.Generator) -> object:
    if kind == "char":
        return rng.integers(32, 127, rng.integers(0, length + 1), dtype=np.uint8).tobytes()
    many = max(length, 1)
    if kind == "float":
        values = rng.normal(0.0, 100.0, many).astype(np.float32).tolist()
    else:
        limits = np.iinfo(_INTEGERS[kind])
        values = rng.integers(limits.min, limits.max, many, dtype=limits.dtype, endpoint=True).tolist()
    if rng.random() < 0.3:
        values = [0] * many
    return values if length else values[0]


@dataclass(frozen=True)
class Message:
    """One decoded message, however it was decoded."""

    name: str
    system: int
    component: int
    fields: tuple[object, ...]


def one_by_one(columns: list[Columns]) -> list[Message]:
    """The messages in the order of the stream."""
    rows = []
    for column in columns:
        values = zip(*(_exact(field) for field in column.fields.values()), strict=True)
        for order, fields in zip(column.order.tolist(), values, strict=True):
            rows.append((order, Message(column.name, column.system, column.component, fields)))
    return [message for _, message in sorted(rows, key=lambda row: row[0])]


def _exact(field: np.ndarray) -> list[object]:
    """Values that compare equal when they are the same bits, NaN too."""
    if field.dtype.kind == "f":
        field = field.view(f"u{field.dtype.itemsize}") if field.flags.c_contiguous else _bits(field)
    return [tuple(value) if isinstance(value, list) else value for value in field.tolist()]


def _bits(field: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(field).view(f"u{field.dtype.itemsize}")


def by_pymavlink(path: Path) -> list[tuple[float, Message]]:
    """What pymavlink reads from a log, of the messages the advisor knows, with its time stamps."""
    log = mavutil.mavlogfile(str(path))
    try:
        rows = []
        while (message := log.recv_msg()) is not None:
            if message.get_type() in DEFINITIONS:
                rows.append((message._timestamp, as_message(message)))
        return rows
    finally:
        log.close()


def as_message(message: dialect.MAVLink_message) -> Message:
    fields = []
    for name in message.ordered_fieldnames:
        value = getattr(message, name)
        kind = message.fieldtypes[message.fieldnames.index(name)]
        if kind == "char":
            value = value.encode() if isinstance(value, str) else bytes(value)
        elif kind == "float":
            value = _float_bits(value)
        elif isinstance(value, list):
            value = tuple(value)
        fields.append(value)
    return Message(message.get_type(), message.get_srcSystem(), message.get_srcComponent(), tuple(fields))


def _float_bits(value: float | list[float]) -> int | tuple[int, ...]:
    bits = np.asarray(value, dtype="<f4").view("<u4").tolist()
    return tuple(bits) if isinstance(bits, list) else bits
