"""Telemetry as the world sends it: all natural numbers act in every flight of one stratum together.

The generators' own nuisances act in every flight (``natural_share`` of 1): filters, an autopilot's angle of
attack, indicated air speed. This module changes the messages of a log further. The sizes are those of data
sheets and of logs of autopilots: MEMS gyro and accelerometer, attitude filter, pitot tube.
"""

from collections.abc import Iterator
from dataclasses import asdict, dataclass
from io import BytesIO
from zlib import crc32

import numpy as np
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from benchmarks.sealed.tlog import EPOCH_US, Timed, packed
from sim.sealed.cases import SealedCase

SERVO, HUD = "SERVO_OUTPUT_RAW", "VFR_HUD"
_FORCES = {"RAW_IMU": 1e3 / 9.80665, "SCALED_IMU2": 1e3 / 9.80665, "HIGHRES_IMU": 1.0}
"""Message to its unit of the specific force, per m/s²."""


@dataclass(frozen=True)
class World:
    """Natural numbers of one flight."""

    command_late_s: float
    """Time by which commands act after their stamps, s."""
    read_over_true: float
    """Read air speed over that of the generator."""
    airspeed_late_s: float
    airspeed_renewed_s: float
    """Time between two new values of the air speed, s."""
    gyro_bias_rad_s: float
    """Bias of the rates at the start, rad/s."""
    gyro_drift_rad_s2: float
    """Change of the bias with time, rad/s²."""
    force_bias_m_s2: tuple[float, float, float]
    attitude_error_rad: tuple[float, float]
    """Errors of bank and pitch angle, rad."""
    drift_period_s: float
    """Period of the slow attitude error, s."""


def draw_world(rng: np.random.Generator) -> World:
    """Draw the natural numbers of one flight."""

    def either(low: float, high: float) -> float:
        return float(rng.choice([-1.0, 1.0]) * rng.uniform(low, high))

    bias = np.radians(either(0.05, 0.2))
    return World(
        command_late_s=float(rng.uniform(0.0, 0.016)),
        read_over_true=1.0 - float(rng.uniform(0.03, 0.05)),
        airspeed_late_s=0.12,
        airspeed_renewed_s=0.1,
        gyro_bias_rad_s=float(bias),
        gyro_drift_rad_s2=float(np.radians(either(0.0, 0.05)) / 100.0),
        force_bias_m_s2=(
            float(rng.normal(0.0, 0.2)),
            float(rng.normal(0.0, 0.2)),
            float(rng.normal(0.0, 0.2)),
        ),
        attitude_error_rad=(float(np.radians(rng.normal(0.0, 0.3))), float(np.radians(rng.normal(0.0, 0.3)))),
        drift_period_s=float(rng.uniform(20.0, 60.0)),
    )


def in_the_world(case: SealedCase, seed: int) -> SealedCase:
    """Return the case with the telemetry of the world; the aircraft file states the read air speed."""
    number = crc32(case.log)
    world = draw_world(np.random.default_rng([seed, number]))
    aircraft = dict(case.aircraft)
    reference = aircraft.get("reference_airspeed_m_s")
    if reference is not None:
        aircraft["reference_airspeed_m_s"] = float(f"{reference * world.read_over_true:.5g}")
    truth = {**case.truth, "world": asdict(world)}
    return SealedCase(case.name, truth, packed(list(changed(messages_of(case.log), world))), aircraft)


def messages_of(log: bytes) -> list[Timed]:
    """Return the messages of a tlog with their times since the first epoch of the generators, s."""
    reader = mavlink.MAVLink(BytesIO())
    reader.robust_parsing = True
    timed, at = [], 0
    while at + 8 < len(log):
        stamp_us = int.from_bytes(log[at : at + 8], "big")
        length = _frame_length(log, at + 8)
        message = reader.decode(bytearray(log[at + 8 : at + 8 + length]))
        timed.append(((stamp_us - EPOCH_US) * 1e-6, message))
        at += 8 + length
    return timed


def _frame_length(log: bytes, at: int) -> int:
    """Return the length of the frame that begins at a byte of a log."""
    payload = log[at + 1]
    return payload + (12 + 13 * (log[at + 2] & 1) if log[at] == 0xFD else 8)


def changed(timed: list[Timed], world: World) -> Iterator[Timed]:
    """Yield the messages as the world sends them."""
    speeds = [(sent, m.airspeed) for sent, m in timed if m.get_type() == HUD]
    read = np.array(speeds).T if speeds else np.zeros((2, 1))
    first_s = timed[0][0]
    for sent, message in timed:
        kind, flown_s = message.get_type(), sent - first_s
        if kind == SERVO:
            message.time_usec = max(message.time_usec - round(1e6 * world.command_late_s), 0)
        elif kind == HUD:
            renewed = np.floor(sent / world.airspeed_renewed_s) * world.airspeed_renewed_s
            message.airspeed = world.read_over_true * float(
                np.interp(renewed - world.airspeed_late_s, read[0], read[1])
            )
        elif kind == "ATTITUDE":
            bias = world.gyro_bias_rad_s + world.gyro_drift_rad_s2 * flown_s
            message.rollspeed, message.pitchspeed, message.yawspeed = (
                rate + bias for rate in (message.rollspeed, message.pitchspeed, message.yawspeed)
            )
            swing = float(np.sin(2.0 * np.pi * flown_s / world.drift_period_s))
            message.roll += world.attitude_error_rad[0] * swing
            message.pitch += world.attitude_error_rad[1] * swing
        elif kind in _FORCES:
            for name, bias in zip(("xacc", "yacc", "zacc"), world.force_bias_m_s2, strict=True):
                value = getattr(message, name) + _FORCES[kind] * bias
                setattr(message, name, value if kind == "HIGHRES_IMU" else round(value))
        yield sent, message
