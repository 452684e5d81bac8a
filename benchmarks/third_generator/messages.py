"""The streams as MAVLink messages of an ArduPlane."""

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from benchmarks.second_generator.tlog import (
    Timed,
    Wiring,
    imu_message,
    int16,
    microseconds,
    milliseconds,
    packed,
    parameters,
)

from .recording import Stream

MANUAL, STABILIZE = 0, 2
HEARTBEAT_S = 1.0


def _rows(stream: Stream, *channels: str) -> zip:  # type: ignore[type-arg]
    return zip(stream.stamps.tolist(), *(stream.channels[name].tolist() for name in channels), strict=True)


def _beats(wiring: Wiring, end_s: float, mode: int) -> list[Timed]:
    out: list[Timed] = [
        (wiring.boot_s + k, mavlink.MAVLink_heartbeat_message(1, 3, 81, mode, 4, 3))
        for k in np.arange(0.0, end_s, HEARTBEAT_S).tolist()
    ]
    values = parameters(wiring)
    for k, (name, value) in enumerate(values.items()):
        message = mavlink.MAVLink_param_value_message(name.encode(), value, 9, len(values), k)
        out.append((wiring.boot_s + 0.02 + 0.004 * k, message))
    return out


def _fast(streams: dict[str, Stream], wiring: Wiring) -> list[Timed]:
    boot, out = wiring.boot_s, []
    for stamp, alpha in _rows(streams["alpha"], "alpha") if "alpha" in streams else ():
        at = boot + stamp
        out.append((at, mavlink.MAVLink_aoa_ssa_message(microseconds(at), float(np.degrees(alpha)), 0.0)))
    for stamp, q, theta in _rows(streams["attitude"], "q", "theta"):
        at = boot + stamp
        out.append((at, mavlink.MAVLink_attitude_message(milliseconds(at), 0.0, theta, 0.0, 0.0, q, 0.0)))
    for stamp, a_x, a_z, q in _rows(streams["imu"], "a_x", "a_z", "imu_q"):
        out.append((boot + stamp, imu_message(wiring.imu, boot + stamp, a_x, a_z, q)))
    for stamp, command, throttle in _rows(streams["servo"], "command", "throttle"):
        widths = [1500] * 8 + [0] * 8
        widths[wiring.outputs()["throttle"] - 1] = round(
            float(np.clip(1100.0 + 500.0 * throttle, 1100.0, 1900.0))
        )
        widths[wiring.elevator_output - 1] = wiring.pulse_width(command)
        at = boot + stamp
        out.append((at, mavlink.MAVLink_servo_output_raw_message(microseconds(at) & 0xFFFFFFFF, 0, *widths)))
    return out


def _slow(streams: dict[str, Stream], wiring: Wiring, height_0: float) -> list[Timed]:
    boot, out = wiring.boot_s, []
    for stamp, airspeed, climb, height, throttle in _rows(
        streams["hud"], "airspeed", "climb", "height", "throttle"
    ):
        percent = int(np.clip(62.5 * throttle, 0.0, 100.0))
        message = mavlink.MAVLink_vfr_hud_message(airspeed, airspeed, 90, percent, height_0 + height, climb)
        out.append((boot + stamp, message))
    north_m, before = 0.0, 0.0
    for stamp, climb, height, airspeed in _rows(streams["position"], "climb", "height", "airspeed"):
        north_m, before = north_m + airspeed * (stamp - before), stamp
        message = mavlink.MAVLink_global_position_int_message(
            milliseconds(boot + stamp),
            round(481_000_000 + north_m * 89.8),
            112_000_000,
            round((height_0 + height) * 1e3),
            round(height * 1e3),
            int16(airspeed * 100.0),
            0,
            int16(-climb * 100.0),
            9000,
        )
        out.append((boot + stamp, message))
    return out


def log_bytes(streams: dict[str, Stream], wiring: Wiring, height_0: float, mode: int) -> bytes:
    """The whole tlog; ``height_0``: height of the ground [m]."""
    end = float(streams["attitude"].stamps[-1])
    return packed(_beats(wiring, end, mode) + _fast(streams, wiring) + _slow(streams, wiring, height_0))
