"""Conversion of messages to physical quantities: units, signs and sources, each sample at its own stamp.

SERVO_OUTPUT_RAW carries sixteen outputs, and its ``port`` names the bank. A surface whose outputs lie in two
banks needs two messages for one sample.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.clocks import place
from advisor.flight.signals.messages import Columns, cut, joined
from advisor.process.arrays import FloatArray, IntArray

ARMED = 128
"""MAV_MODE_FLAG_SAFETYARMED, MAVLink common.xml."""
_MILLI_G = GRAVITY_M_S2 / 1000.0

# The counters that stamp messages (field, length of a tick in s); MAVLink common.xml, ardupilotmega.xml.
_BOOT_MS = ("time_boot_ms", 1e-3)
_USEC = ("time_usec", 1e-6)


@dataclass(frozen=True, slots=True)
class Reading:
    """Field of a message that holds one physical quantity, with its conversion to SI units."""

    channel: str
    message: str
    field: str
    value: Callable[..., FloatArray]
    """Function that converts ``field``, and ``second`` if given, to SI units."""
    provenance: str = "measured"
    second: str = ""

    @property
    def source(self) -> str:
        """``MESSAGE.field``."""
        return f"{self.message}.{self.field}"


def _scaled(factor: float) -> Callable[[NDArray[Any]], FloatArray]:
    return lambda raw: np.asarray(raw, dtype=np.float64) * factor


def _towards(part: Callable[[FloatArray], FloatArray]) -> Callable[..., FloatArray]:
    """Return a function for a wind component from the wind's speed and the direction it blows from."""
    return lambda speed, from_deg: -np.asarray(speed, dtype=np.float64) * part(np.radians(from_deg))


_FORCES = (("a_x", "xacc"), ("a_y", "yacc"), ("a_z", "zacc"))
"""Components of the specific force with their message fields."""

READINGS = (
    Reading("q", "ATTITUDE", "pitchspeed", _scaled(1.0)),
    Reading("p", "ATTITUDE", "rollspeed", _scaled(1.0)),
    Reading("r", "ATTITUDE", "yawspeed", _scaled(1.0)),
    Reading("theta", "ATTITUDE", "pitch", _scaled(1.0)),
    Reading("bank", "ATTITUDE", "roll", _scaled(1.0)),
    Reading("alpha", "AOA_SSA", "AOA", np.radians, "derived"),
    Reading("beta", "AOA_SSA", "SSA", np.radians, "derived"),
    Reading("airspeed", "VFR_HUD", "true_airspeed", _scaled(1.0)),
    Reading("airspeed", "VFR_HUD", "airspeed", _scaled(1.0)),
    Reading("climb_rate", "VFR_HUD", "climb", _scaled(1.0)),
    Reading("throttle", "VFR_HUD", "throttle", _scaled(0.01)),
    *(
        Reading(channel, message, field, _scaled(_MILLI_G))
        for message in ("RAW_IMU", "SCALED_IMU")
        for channel, field in _FORCES
    ),
    *(Reading(channel, "HIGHRES_IMU", field, _scaled(1.0)) for channel, field in _FORCES),
    # Second and third sensors of an autopilot, used where the first is not sent.
    *(
        Reading(channel, message, field, _scaled(_MILLI_G))
        for message in ("SCALED_IMU2", "SCALED_IMU3")
        for channel, field in _FORCES
    ),
    Reading("height", "GLOBAL_POSITION_INT", "relative_alt", _scaled(1e-3)),
    Reading("altitude", "GLOBAL_POSITION_INT", "alt", _scaled(1e-3)),
    Reading("altitude", "VFR_HUD", "alt", _scaled(1.0)),
    Reading("altitude", "GPS_RAW_INT", "alt", _scaled(1e-3)),
    Reading("static_pressure", "SCALED_PRESSURE", "press_abs", _scaled(100.0)),
    Reading("static_pressure", "HIGHRES_IMU", "abs_pressure", _scaled(100.0)),
    Reading("heading", "ATTITUDE", "yaw", _scaled(1.0)),
    Reading("wind_north", "WIND", "speed", _towards(np.cos), "derived", "direction"),
    Reading("wind_east", "WIND", "speed", _towards(np.sin), "derived", "direction"),
    Reading("wind_north", "WIND_COV", "wind_x", _scaled(1.0), "derived"),
    Reading("wind_east", "WIND_COV", "wind_y", _scaled(1.0), "derived"),
    Reading("groundspeed", "VFR_HUD", "groundspeed", _scaled(1.0)),
    Reading("landed_state", "EXTENDED_SYS_STATE", "landed_state", _scaled(1.0)),
    Reading("armed", "HEARTBEAT", "base_mode", lambda raw: (np.asarray(raw) & ARMED > 0).astype(np.float64)),
)
"""Sources of each channel, the best source first."""

COMPANIONS = ("NAMED_VALUE_FLOAT", "AOA_SSA")
"""Messages that another component may send, such as an onboard computer with a vane."""
COMPANION_ALPHA = "AOA_SSA.AOA of an onboard computer"
"""Source name of an angle of attack from an onboard computer."""

_STAMPS = {
    "ATTITUDE": _BOOT_MS,
    "ATTITUDE_QUATERNION": _BOOT_MS,
    "AOA_SSA": _USEC,
    "RAW_IMU": _USEC,
    "SCALED_IMU": _BOOT_MS,
    "SCALED_IMU2": _BOOT_MS,
    "SCALED_IMU3": _BOOT_MS,
    "SCALED_PRESSURE": _BOOT_MS,
    "HIGHRES_IMU": _USEC,
    "GLOBAL_POSITION_INT": _BOOT_MS,
    "SERVO_OUTPUT_RAW": _USEC,
    "ACTUATOR_OUTPUT_STATUS": _USEC,
    "NAMED_VALUE_FLOAT": _BOOT_MS,
    "RC_CHANNELS": _BOOT_MS,
    "VFR_HUD": _USEC,
    "WIND": _USEC,
    "WIND_COV": _USEC,
}
"""Stamp field of each message, by the message's name. On a link VFR_HUD and WIND have no stamp, and take that
of the last ATTITUDE. Logs of autopilots stamp both messages."""

GIVEN_AIRSPEED = "airspeed_m_s of the aircraft file"
"""Source name of an air speed from the aircraft file."""
GIVEN_HEIGHT = "reference.height_m of the aircraft file"
"""Source name of a pressure altitude from the aircraft file."""
TRUE_AIRSPEED = "VFR_HUD.true_airspeed"
"""Source name of a true air speed that the autopilot logged in addition to the calibrated one. Links do not
carry a true air speed."""


@dataclass(frozen=True, slots=True)
class Decoded:
    """Samples of one channel from one source, in order of arrival."""

    channel: str
    source: str
    provenance: str
    t: FloatArray
    y: FloatArray
    order: NDArray[np.int64]


def stamps(columns: Columns, master_s: FloatArray) -> FloatArray:
    """Return the vehicle time of each message, shape (n,), s since boot; NaN for an implausible stamp.

    Parameters
    ----------
    master_s
        Shape (n,): master clock at the arrival of each message, s since boot.
    """
    field, tick_s = _STAMPS.get(columns.name, ("", 0.0))
    if field not in columns.fields:
        return master_s
    return place(columns.fields[field], tick_s, master_s)


def quantities(columns: Columns, t: FloatArray) -> Iterator[Decoded]:
    """Yield every quantity of ``READINGS`` that a message type contains."""
    for reading in READINGS:
        if reading.message == columns.name and reading.field in columns.fields:
            fields = filter(None, (reading.field, reading.second))
            y = reading.value(*(columns.fields[name] for name in fields))
            yield _decoded(reading.channel, reading.source, reading.provenance, t, y, columns)


def of_companion(decoded: Decoded) -> Decoded:
    """Return a quantity with the source name of another component than the autopilot. The component's method
    of measurement is unknown."""
    return replace(decoded, source=f"{decoded.source} of an onboard computer", provenance="unknown")


def named_value(columns: Columns, t: FloatArray, channel: str, name: str) -> Decoded:
    """Return a vane's channel from NAMED_VALUE_FLOAT messages with a given name, in the sender's unit."""
    mine = np.array(
        [raw.rstrip(b"\0") == name.encode() for raw in columns.fields["name"].tolist()], dtype=bool
    )
    y = np.where(mine, np.asarray(columns.fields["value"], dtype=np.float64), np.nan)
    return _decoded(channel, f"NAMED_VALUE_FLOAT.{name}", "vane", t, y, columns)


def given_airspeed(attitude: Columns, t: FloatArray, airspeed_m_s: float) -> Decoded:
    """Return the aircraft file's air speed at the stamps of ATTITUDE, for a log without air speed."""
    return _decoded("airspeed", GIVEN_AIRSPEED, "given", t, np.full(len(t), airspeed_m_s), attitude)


def _decoded(
    channel: str, source: str, provenance: str, t: FloatArray, y: FloatArray, columns: Columns
) -> Decoded:
    good = np.isfinite(t) & np.isfinite(y)
    return Decoded(channel, source, provenance, t[good], y[good], columns.order[good])


_OUTPUTS = 16
"""Number of outputs in one SERVO_OUTPUT_RAW (MAVLink's common.xml)."""


@dataclass(frozen=True, slots=True)
class Pulses:
    """Pulse widths of the servo outputs, with the messages that contained them."""

    columns: Columns
    """The n messages of the batch."""
    ports: IntArray
    """Shape (m + n,): bank of each message, where the first m are earlier messages."""
    raw: FloatArray
    """Shape (m + n, outputs of a bank): pulse widths, us."""

    def of(self, outputs: Sequence[int]) -> FloatArray:
        """Return the pulse widths of the given outputs, shape (n, number of outputs), us.

        Each message of the last bank gives a sample, with the newest pulses of the other banks. NaN marks a
        message of another bank. NaN also marks a sample if another bank sent nothing since the sample before.
        """
        size = self.raw.shape[1]
        banks = [(n - 1) // size for n in outputs]
        rows = np.arange(len(self.ports))
        of_last = self.ports == max(banks)
        before = np.concatenate(([-1], np.maximum.accumulate(np.where(of_last, rows, -1))[:-1]))
        pulses = np.full((len(rows), len(outputs)), np.nan)
        for k, (n, bank) in enumerate(zip(outputs, banks, strict=True)):
            newest = np.maximum.accumulate(np.where(self.ports == bank, rows, -1))
            complete = of_last & (newest > before)
            pulses[complete, k] = self.raw[newest[complete], (n - 1) % size]
        return pulses[len(rows) - len(self.columns.order) :]

    def source(self, outputs: Sequence[int]) -> str:
        """Return the source of the given outputs as ``MESSAGE.field+field``."""
        if self.columns.name == "ACTUATOR_OUTPUT_STATUS":
            return f"{self.columns.name}.actuator" + "+".join(f"[{n - 1}]" for n in outputs)
        banks = {(n - 1) // _OUTPUTS for n in outputs}
        names = [
            f"port{(n - 1) // _OUTPUTS}.servo{(n - 1) % _OUTPUTS + 1}_raw"
            if len(banks) > 1
            else f"servo{(n - 1) % _OUTPUTS + 1}_raw"
            for n in outputs
        ]
        return f"{self.columns.name}." + "+".join(names)


def merged(part: Sequence[Columns]) -> list[Columns]:
    """Return the columns with one sender's SERVO_OUTPUT_RAW merged, which some logs separate by bank."""
    senders: dict[int, list[Columns]] = {}
    for c in part:
        if c.name == "SERVO_OUTPUT_RAW":
            senders.setdefault(c.component, []).append(c)
    kept = [c for c in part if c.name != "SERVO_OUTPUT_RAW"]
    return kept + [_in_order(joined(banks)) if len(banks) > 1 else banks[0] for banks in senders.values()]


def _in_order(banks: Columns) -> Columns:
    return cut(banks, np.argsort(banks.order))


class Banks:
    """Memory of the last message of every bank."""

    def __init__(self) -> None:
        self._ports: IntArray = np.empty(0, dtype=np.int64)
        self._raw: FloatArray = np.empty((0, _OUTPUTS))

    def together(self, columns: Columns) -> Pulses:
        """Return the pulses of servo output messages, completed by earlier messages."""
        if columns.name == "ACTUATOR_OUTPUT_STATUS":
            every = np.asarray(columns.fields["actuator"], dtype=np.float64)
            return Pulses(columns, np.zeros(len(every), dtype=np.int64), every)
        silent = np.zeros(len(columns.order))
        fields = [columns.fields.get(f"servo{k}_raw", silent) for k in range(1, _OUTPUTS + 1)]
        ports = np.concatenate((self._ports, np.asarray(columns.fields["port"], dtype=np.int64)))
        raw = np.concatenate((self._raw, np.stack(fields, axis=1).astype(np.float64)))
        last = [int(np.flatnonzero(ports == port)[-1]) for port in np.unique(ports)]
        kept = np.sort(last)
        self._ports, self._raw = ports[kept], raw[kept]
        return Pulses(columns, ports, raw)
