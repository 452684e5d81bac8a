"""The streams as MAVLink 2 frames of an ArduPlane, in a tlog."""

import os
import struct
from collections.abc import Mapping
from dataclasses import dataclass

os.environ.setdefault("MAVLINK20", "1")

import numpy as np
from numpy.typing import NDArray
from pymavlink.dialects.v20 import ardupilotmega as mavlink

EPOCH_US = (
    1_750_000_000_000_000  # every log begins at the same moment, so that a log depends on its seed only
)
STANDARD_GRAVITY = 9.80665
"""Unit of the accelerometers in RAW_IMU and SCALED_IMU2, m/s²."""
SERVO_FUNCTIONS = {"aileron": 4, "throttle": 70, "rudder": 21, "elevator": 19}
IMU_MESSAGES = ("RAW_IMU", "SCALED_IMU2", "HIGHRES_IMU")

_ALL_BUT_DIFFERENTIAL = 0b1_1011_1111_1111
"""Fields that HIGHRES_IMU marks as updated: all but the differential pressure."""
MANUAL, STABILIZE = 0, 2
"""Modes of ArduPlane."""

Timed = tuple[float, mavlink.MAVLink_message]


@dataclass(frozen=True)
class Stream:
    """Samples that travel in one message: stamps [s since the log began] and values by channel, SI."""

    stamps: NDArray[np.float64]
    channels: dict[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Wiring:
    """Which output moves what; the elevator's calibration as pulse widths [us] and deflections [deg]."""

    elevator_output: int
    reversed: bool
    calibration: tuple[tuple[float, float], ...]
    imu: str
    boot_s: float

    def pulse_width(self, elevator_rad: float) -> int:
        """Pulse width [us] for an elevator deflection, positive trailing edge down."""
        points = sorted(self.calibration, key=lambda point: point[1])
        degrees = [point[1] for point in points]
        return round(float(np.interp(np.degrees(elevator_rad), degrees, [point[0] for point in points])))

    def outputs(self) -> dict[str, int]:
        """Output number of each function; the elevator's displaces one of the others."""
        numbers = [n for n in range(1, 6) if n != self.elevator_output]
        others = dict(zip(("aileron", "throttle", "rudder"), numbers, strict=False))
        return dict(others, elevator=self.elevator_output)


def parameters(wiring: Wiring) -> dict[str, float]:
    """SERVOn_ parameters of the outputs in use."""
    low, middle, high = sorted(point[0] for point in wiring.calibration)
    values = {}
    for function, output in sorted(wiring.outputs().items(), key=lambda item: item[1]):
        elevator = function == "elevator"
        values[f"SERVO{output}_FUNCTION"] = float(SERVO_FUNCTIONS[function])
        values[f"SERVO{output}_MIN"] = low if elevator else 1100.0
        values[f"SERVO{output}_TRIM"] = middle if elevator else 1500.0
        values[f"SERVO{output}_MAX"] = high if elevator else 1900.0
        values[f"SERVO{output}_REVERSED"] = float(wiring.reversed and elevator)
    return values


def milliseconds(seconds: float) -> int:
    return round(seconds * 1e3) & 0xFFFFFFFF


def microseconds(seconds: float) -> int:
    return round(seconds * 1e6)


def int16(value: float) -> int:
    return int(np.clip(round(value), -32768, 32767))


def pressure_hpa(altitude_m: float) -> float:
    """Pressure of the standard atmosphere below 11 km (ISO 2533)."""
    return float(1013.25 * (1.0 - 2.25577e-5 * altitude_m) ** 5.25588)


def imu_message(
    name: str, stamp: float, a_x: float, a_z: float, q: float, altitude_m: float
) -> mavlink.MAVLink_message:
    if name == "HIGHRES_IMU":
        air = pressure_hpa(altitude_m), 0.0, altitude_m, 20.0
        return mavlink.MAVLink_highres_imu_message(
            microseconds(stamp), a_x, 0.0, a_z, 0.0, q, 0.0, 0.2, 0.0, 0.4, *air, _ALL_BUT_DIFFERENTIAL
        )
    milli_g, milli_rate = 1e3 / STANDARD_GRAVITY, 1e3
    values = (int16(a_x * milli_g), 0, int16(a_z * milli_g), 0, int16(q * milli_rate), 0, 200, 0, 400)
    if name == "RAW_IMU":
        return mavlink.MAVLink_raw_imu_message(microseconds(stamp), *values)
    return mavlink.MAVLink_scaled_imu2_message(milliseconds(stamp), *values)


def _servo(stamp: float, elevator_us: int, throttle_us: int, wiring: Wiring) -> mavlink.MAVLink_message:
    widths = [1500] * 8 + [0] * 8
    outputs = wiring.outputs()
    widths[outputs["throttle"] - 1] = throttle_us
    widths[outputs["elevator"] - 1] = elevator_us
    return mavlink.MAVLink_servo_output_raw_message(microseconds(stamp) & 0xFFFFFFFF, 0, *widths)


def _rows(stream: Stream, *channels: str) -> zip:  # type: ignore[type-arg]
    columns = [stream.channels[channel].tolist() for channel in channels]
    return zip(stream.stamps.tolist(), *columns, strict=True)


def messages(
    streams: dict[str, Stream],
    wiring: Wiring,
    elevation_m: float,
    mode: int = MANUAL,
    stated: Mapping[str, float] | None = None,
) -> list[Timed]:
    """Every message with the time since boot [s] at which the vehicle sent it.

    The streams are ``attitude``, ``imu``, ``servo`` (with ``throttle_us``), ``hud`` (with
    ``throttle_percent``), ``position``, and ``alpha`` where the vehicle sends an angle of attack. ``stated``
    has further parameters.
    """
    boot, last = wiring.boot_s, float(streams["attitude"].stamps[-1])
    beat = mavlink.MAVLink_heartbeat_message(1, 3, 81, mode, 4, 3)
    out: list[Timed] = [(boot + k, beat) for k in range(int(last) + 1)]
    values = parameters(wiring) | dict(stated or {})
    for k, (name, value) in enumerate(values.items()):
        message = mavlink.MAVLink_param_value_message(name.encode(), value, 9, len(values), k)
        out.append((boot + 0.01 + 0.005 * k, message))
    for stamp, alpha in _rows(streams["alpha"], "alpha") if "alpha" in streams else ():
        sent = boot + stamp
        out.append((sent, mavlink.MAVLink_aoa_ssa_message(microseconds(sent), float(np.degrees(alpha)), 0.0)))
    for stamp, q, theta in _rows(streams["attitude"], "q", "theta"):
        sent = boot + stamp
        message = mavlink.MAVLink_attitude_message(milliseconds(sent), 0.0, theta, 0.0, 0.0, q, 0.0)
        out.append((sent, message))
    imu, hud = streams["imu"], streams["hud"]
    altitudes = (elevation_m + np.interp(imu.stamps, hud.stamps, hud.channels["height"])).tolist()
    for (stamp, a_x, a_z, q), altitude in zip(_rows(imu, "a_x", "a_z", "imu_q"), altitudes, strict=True):
        out.append((boot + stamp, imu_message(wiring.imu, boot + stamp, a_x, a_z, q, altitude)))
    for stamp, command, throttle_us in _rows(streams["servo"], "command", "throttle_us"):
        width = round(float(np.clip(throttle_us, 1100.0, 1900.0)))
        out.append((boot + stamp, _servo(boot + stamp, wiring.pulse_width(command), width, wiring)))
    out += _slow_messages(streams, wiring, elevation_m)
    return out


def _slow_messages(streams: dict[str, Stream], wiring: Wiring, elevation_m: float) -> list[Timed]:
    boot, out = wiring.boot_s, []
    hud, position = streams["hud"], streams["position"]
    # An autopilot repeats its receiver's ground speed; that is no pressure, so it knows no thin air.
    over_ground = np.interp(hud.stamps, position.stamps, position.channels["groundspeed"]).tolist()
    rows = _rows(hud, "airspeed", "climb", "height", "throttle_percent")
    for (stamp, airspeed, climb, height, throttle), groundspeed in zip(rows, over_ground, strict=True):
        message = mavlink.MAVLink_vfr_hud_message(
            airspeed, groundspeed, 0, int(np.clip(throttle, 0.0, 100.0)), elevation_m + height, climb
        )
        out.append((boot + stamp, message))
    north_m, before = 0.0, 0.0
    for stamp, climb, height, groundspeed in _rows(position, "climb", "height", "groundspeed"):
        north_m, before = north_m + groundspeed * (stamp - before), stamp
        message = mavlink.MAVLink_global_position_int_message(
            milliseconds(boot + stamp),
            round(473_000_000 + north_m * 89.8),
            85_000_000,
            round((elevation_m + height) * 1e3),
            round(height * 1e3),
            int16(groundspeed * 100.0),
            0,
            int16(-climb * 100.0),
            0,
        )
        out.append((boot + stamp, message))
    return out


def packed(timed: list[Timed]) -> bytes:
    """Messages as records in the order of sending, each with the ground's clock."""
    link = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    parts = []
    for sent, message in sorted(timed, key=lambda pair: pair[0]):
        frame = message.pack(link)
        link.seq = (link.seq + 1) % 256
        # The low two bits of the stamp name the link it came on: zero.
        parts.append(struct.pack(">Q", (EPOCH_US + microseconds(sent)) & ~3) + frame)
    return b"".join(parts)


def tlog(
    streams: dict[str, Stream],
    wiring: Wiring,
    elevation_m: float,
    mode: int = MANUAL,
    stated: Mapping[str, float] | None = None,
) -> bytes:
    """The whole log; ``stated`` has further parameters."""
    return packed(messages(streams, wiring, elevation_m, mode, stated))
