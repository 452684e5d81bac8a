"""Columns of a vehicle's messages, as a reader gives them."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from advisor.flight.signals.messages import Columns
from advisor.process.arrays import FloatArray

HOST_S = 1_790_000_000.0


def columns(name: str, arrival_s: FloatArray, order: Sequence[int] | None = None, **fields: Any) -> Columns:
    """Messages of one type that arrive at these vehicle seconds; numbers are repeated as needed."""
    n = len(arrival_s)
    filled = {key: np.broadcast_to(np.asarray(value), (n,)).copy() for key, value in fields.items()}
    at = np.arange(n) if order is None else np.asarray(order)
    return Columns(name, 1, 1, at.astype(np.int64), HOST_S + arrival_s, filled)


def attitude(t: FloatArray, arrival_s: FloatArray | None = None) -> Columns:
    """ATTITUDE stamped at ``t``, every value new."""
    return columns(
        "ATTITUDE",
        t if arrival_s is None else arrival_s,
        order=np.arange(len(t)) * 100,
        time_boot_ms=np.round(t * 1e3).astype(np.uint32),
        roll=0.0,
        pitch=0.05,
        rollspeed=0.0,
        yawspeed=0.0,
        pitchspeed=np.sin(7.0 * t) + 1e-4 * np.arange(len(t)),
    )


def among(master: Columns, t: FloatArray, master_s: FloatArray) -> list[int]:
    """Orders of messages stamped ``t`` that arrive between the ATTITUDE messages of ``master``."""
    after = np.searchsorted(master_s, t, side="right") - 1
    base = np.where(after >= 0, master.order[np.maximum(after, 0)], -1)
    same = np.arange(len(t)) - np.searchsorted(after, after)
    return [int(o) + 1 + int(k) for o, k in zip(base, same, strict=True)]


def heartbeat(autopilot: int = 3, kind: int = 1) -> Columns:
    return columns(
        "HEARTBEAT", np.zeros(1), order=[-10], type=kind, autopilot=autopilot, custom_mode=0, base_mode=0
    )


def parameters(values: dict[str, float]) -> Columns:
    names = np.array([name.encode() for name in values], dtype="S16")
    return columns(
        "PARAM_VALUE",
        np.zeros(len(values)),
        order=np.arange(len(values)) - 9 - len(values),
        param_id=names,
        param_value=np.array(list(values.values())),
    )


def servo(t: FloatArray, order: Sequence[int], pulse: int = 1500) -> Columns:
    fields = {f"servo{n}_raw": 1500 for n in range(1, 17)} | {"servo2_raw": pulse}
    return columns(
        "SERVO_OUTPUT_RAW", t, order, time_usec=np.round(t * 1e6).astype(np.uint32), port=0, **fields
    )


def aoa(t: FloatArray, order: Sequence[int], renewed_hz: float) -> Columns:
    """AOA_SSA whose value is renewed at this pace under fresh stamps."""
    value = np.sin(3.0 * np.floor(t * renewed_hz + 1e-6) / renewed_hz)
    return columns("AOA_SSA", t, order, time_usec=np.round(t * 1e6).astype(np.uint64), AOA=value, SSA=0.0)


def hud(t: FloatArray, order: Sequence[int]) -> Columns:
    return columns(
        "VFR_HUD", t, order, airspeed=25.0 + 0.01 * np.arange(len(t)), throttle=50, climb=0.0, alt=100.0
    )


def imu(t: FloatArray, order: Sequence[int]) -> Columns:
    return columns(
        "RAW_IMU",
        t,
        order,
        time_usec=np.round(t * 1e6).astype(np.uint64),
        xacc=10,
        yacc=0,
        zacc=-1000 + (np.arange(len(t)) % 2),
    )


def flight(
    rate_hz: float = 50.0,
    seconds: float = 20.0,
    without: Iterable[str] = (),
    setup: dict[str, float] | None = None,
    autopilot: int = 3,
    **rates_hz: float,
) -> list[Columns]:
    """Everything a good ArduPlane link holds; single messages at rates of their own."""
    t = {
        name: np.arange(1.0, 1.0 + seconds, 1.0 / rates_hz.get(name, rate_hz))
        for name in ("ATTITUDE", "SERVO_OUTPUT_RAW", "AOA_SSA", "VFR_HUD", "RAW_IMU")
    }
    master = attitude(t["ATTITUDE"])

    def order(name: str, offset: int) -> list[int]:
        return [o + offset for o in among(master, t[name], t["ATTITUDE"])]

    setup = {"SERVO2_FUNCTION": 19.0} if setup is None else setup
    parts = [
        heartbeat(autopilot),
        *([parameters(setup)] if setup else []),
        master,
        servo(t["SERVO_OUTPUT_RAW"], order("SERVO_OUTPUT_RAW", 0)),
        aoa(t["AOA_SSA"], order("AOA_SSA", 20), rates_hz.get("renewed", 1e6)),
        hud(t["VFR_HUD"], order("VFR_HUD", 40)),
        imu(t["RAW_IMU"], order("RAW_IMU", 60)),
    ]
    return [part for part in parts if part.name not in without]
