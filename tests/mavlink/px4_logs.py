"""A writer of PX4 logs in any set-up, and a flight to put into them."""

import struct
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from advisor.aircraft.aircraft import Aircraft
from advisor.flight.maneuvers.maneuver import ManeuverFlown
from advisor.flight.stream.stream import FlightStream
from tests.heard import hear_log

G = 9.80665
SECONDS = 40.0
FIRST_STEP_S = 20.0
_KINDS = {"u8": "uint64_t", "u4": "uint32_t", "u1": "uint8_t", "i1": "int8_t", "f4": "float"}


class PX4Log:
    """Collects topics as columns; its bytes are those of a ``.ulg``."""

    def __init__(self, **parameters: float) -> None:
        self._topics: dict[tuple[str, int], dict[str, NDArray[Any]]] = {}
        self._parameters = parameters
        self.extra = b""
        """Messages of the data section that come after all samples."""

    def topic(self, name: str, t: ArrayLike, multi_id: int = 0, **fields: ArrayLike) -> "PX4Log":
        """Samples at ``t`` s since boot; fields of shape (n,) or (n, k), or a scalar for all.

        Integers are written as ``int8_t``, a ``timestamp_sample`` as ``uint64_t``, others as ``float``.
        """
        at = np.round(np.asarray(t, dtype=float) * 1e6).astype("u8")
        columns = {"timestamp": at}
        for key, values in fields.items():
            array = np.asarray(values)
            kind = "i1" if array.dtype.kind in "iub" else "f4"
            columns[key] = np.broadcast_to(array.astype(kind), (len(at), *array.shape[1:]))
        self._topics[name, multi_id] = columns
        return self

    def without(self, *names: str) -> "PX4Log":
        """The log without these topics."""
        self._topics = {key: columns for key, columns in self._topics.items() if key[0] not in names}
        return self

    def write(self, folder: Path, name: str = "flight.ulg") -> Path:
        path = folder / name
        path.write_bytes(bytes(self))
        return path

    def __bytes__(self) -> bytes:
        formats = {name: columns for (name, _), columns in self._topics.items()}
        head = [message("F", f"{name}:{_fields(columns)}".encode()) for name, columns in formats.items()]
        head += [parameter(name, value) for name, value in self._parameters.items()]
        data: list[tuple[int, bytes]] = []
        for number, ((name, multi_id), columns) in enumerate(self._topics.items()):
            head.append(message("A", struct.pack("<BH", multi_id, number) + name.encode()))
            rows = np.rec.fromarrays(
                [columns[key] for key in columns],
                dtype=[(key, f"<{v.dtype.str[1:]}", v.shape[1:]) for key, v in columns.items()],
            )
            stamps = columns["timestamp"].tolist()
            data += [
                (at, message("D", struct.pack("<H", number) + row.tobytes()))
                for at, row in zip(stamps, rows, strict=True)
            ]
        body = b"".join(sample for _, sample in sorted(data, key=lambda one: one[0]))
        return b"ULog\x01\x12\x35\x01" + bytes(8) + b"".join(head) + body + self.extra


def message(kind: str, payload: bytes) -> bytes:
    return struct.pack("<HB", len(payload), ord(kind)) + payload


def parameter(name: str, value: float) -> bytes:
    """A parameter of the kind that its value has."""
    kind, form = ("int32_t", "<i") if isinstance(value, int) else ("float", "<f")
    key = f"{kind} {name}".encode()
    return message("P", bytes([len(key)]) + key + struct.pack(form, value))


def _fields(columns: Mapping[str, NDArray[Any]]) -> str:
    sizes = {key: f"[{values.shape[1]}]" if values.ndim > 1 else "" for key, values in columns.items()}
    return "".join(f"{_KINDS[v.dtype.str[1:]]}{sizes[key]} {key};" for key, v in columns.items())


def every(rate_hz: float, late_s: float = 0.0) -> NDArray[np.float64]:
    """Stamps of a topic from 1 s since boot on."""
    return 1.0 + late_s + np.arange(round(SECONDS * rate_hz)) / rate_hz


def stick(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """A pitch command, -1 to 1, positive nose up: a 3-2-1-1 of 0.5 s units between stretches of trim."""
    unit = (t - FIRST_STEP_S) / 0.5
    return np.select(
        [(a <= unit) & (unit < b) for a, b in ((0, 3), (3, 5), (5, 6), (6, 7))], [0.1, -0.1, 0.1, -0.1]
    )


def pitch(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Pitch angle and rate of an aircraft that answers the command within 0.1 s, besides some motion."""
    theta, q = 0.05 + 0.01 * np.sin(t), 0.01 * np.cos(t)
    for unit, change in ((0, 1), (3, -2), (5, 2), (6, -2), (7, 1)):
        since = np.maximum(t - FIRST_STEP_S - 0.5 * unit, 0.0)
        q = q + 0.1 * change * (1.0 - np.exp(-since / 0.1))
        theta = theta + 0.1 * change * (since - 0.1 * (1.0 - np.exp(-since / 0.1)))
    return theta, q


def flight(nav_state: int = 0, **parameters: float) -> PX4Log:
    """Attitude, rates, specific force, air speed and position of a flight; no outputs."""
    log = PX4Log(**parameters)
    t = every(50.0)
    theta, q = pitch(t)
    zero = np.zeros(len(t))
    log.topic("vehicle_angular_velocity", t, xyz=np.column_stack([zero, q, zero]))
    half = theta / 2
    log.topic("vehicle_attitude", t, q=np.column_stack([np.cos(half), zero, np.sin(half), zero]))
    log.topic(
        "sensor_combined",
        t,
        gyro_rad=np.column_stack([zero, q, zero]),
        accelerometer_m_s2=np.column_stack([zero, zero, zero - G]),
    )
    slow = every(25.0)
    log.topic("airspeed", slow, indicated_airspeed_m_s=25.0)
    log.topic("vehicle_local_position", slow, z=-100.0, vz=-0.5)
    log.topic(
        "vehicle_status",
        every(2.0),
        nav_state=np.int8(nav_state),
        vehicle_type=np.int8(2),
        is_vtol=np.int8(0),
    )
    return log


def pulses(t: NDArray[np.float64], outputs: Mapping[int, ArrayLike]) -> NDArray[np.float64]:
    """Outputs 1 to 16 in us, shape (n, 16): those given, others unused."""
    found = np.full((len(t), 16), 900.0)
    for n, values in outputs.items():
        found[:, n - 1] = values
    return found


def flown(
    path: Path, aircraft: Aircraft | None = None
) -> tuple[FlightStream, list[ManeuverFlown], list[str]]:
    """The stream that has read a log, what was flown in it, and what was said."""
    heard = hear_log(path, aircraft)
    flown = [event for event in heard.events if isinstance(event, ManeuverFlown)]
    return heard.stream, flown, [notice.text for notice in heard.notices]
