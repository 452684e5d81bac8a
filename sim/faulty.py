"""Faults of a scenario in outgoing messages."""

import math
from collections.abc import Iterable, Iterator
from copy import copy

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from .airframe import AIR_DENSITY_KG_M3
from .faults import FIELDS, STAMPED, UNITS, Faults, Filters
from .mavlink import Message
from .motion import HOME_HEIGHT_M

SEA_LEVEL_HPA, SEA_LEVEL_K, LAPSE_K_M, PRESSURE_EXPONENT = 1013.25, 288.15, 0.0065, 5.25588
"""Standard atmosphere (ICAO): pressure and temperature at sea level, lapse rate, exponent of the pressure."""


def standard_air(height_m: float) -> tuple[float, float, float]:
    """Return pressure in hPa, temperature in K, and density relative to sea level, of the troposphere."""
    kelvin = SEA_LEVEL_K - LAPSE_K_M * height_m
    pressure = (kelvin / SEA_LEVEL_K) ** PRESSURE_EXPONENT
    return SEA_LEVEL_HPA * pressure, kelvin, pressure * SEA_LEVEL_K / kelvin


def stated(filters: Filters) -> dict[str, float]:
    """Return the parameters that name the filters; empty if the scenario withholds them."""
    if filters.parameters == "withheld":
        return {}
    named = {"INS_GYRO_FILTER": filters.gyro_hz, "INS_ACCEL_FILTER": filters.accelerometer_hz}
    return {name: cutoff_hz for name, cutoff_hz in named.items() if cutoff_hz > 0.0}


class Outgoing:
    """Changes to outgoing messages by the faults."""

    def __init__(self, faults: Faults) -> None:
        self._factors: dict[str, dict[str, float]] = {}
        for channel, factor in (
            *((channel, UNITS[channel][unit]) for channel, unit in faults.units.items()),
            *faults.scale.items(),
        ):
            name, fields = FIELDS[channel]
            factors = self._factors.setdefault(name, {})
            factors.update({each: factors.get(each, 1.0) * factor for each in fields})
        self._shifts = {name: -lag for name, lag in faults.clock_lag_s.items()}
        if faults.command_late_s:
            self._shifts["SERVO_OUTPUT_RAW"] = (
                self._shifts.get("SERVO_OUTPUT_RAW", 0.0) - faults.command_late_s
            )
        self._thin_air_m = faults.thin_air_m
        self._in_g = faults.units.get("accelerometer") == "g"
        self._indicated = 0.0

    def changed(self, messages: Iterable[Message]) -> Iterator[Message]:
        """Yield the messages with the faults of the vehicle."""
        for message in messages:
            name = message.get_type()
            for each, factor in self._factors.get(name, {}).items():
                value = getattr(message, each)
                setattr(message, each, _int16(value * factor) if isinstance(value, int) else value * factor)
            if name in self._shifts:
                _shift(message, self._shifts[name])
            if self._thin_air_m:
                yield from self._thin(message)
            else:
                yield _in_g(message) if self._in_g and name == "RAW_IMU" else message

    def _thin(self, message: Message) -> Iterator[Message]:
        """Yield the message as sent in thin air, with a pressure message after every position."""
        higher_m = self._thin_air_m - HOME_HEIGHT_M
        if message.get_type() == "VFR_HUD":
            message.alt += higher_m
            message.airspeed *= math.sqrt(standard_air(message.alt)[2])
            self._indicated = message.airspeed
        yield message
        if message.get_type() == "GLOBAL_POSITION_INT":
            message.alt += round(1e3 * higher_m)
            pressure, kelvin, _ = standard_air(1e-3 * message.alt)
            dynamic_hpa = 0.005 * AIR_DENSITY_KG_M3 * self._indicated**2
            yield mavlink.MAVLink_scaled_pressure_message(
                message.time_boot_ms, pressure, dynamic_hpa, round(100.0 * (kelvin - 273.15))
            )


def again(message: Message, later_s: float) -> Message:
    """Return the message with its stamp later by ``later_s``."""
    repeated = copy(message)
    if message.get_type() in (*STAMPED, "HIGHRES_IMU", "SCALED_PRESSURE"):
        _shift(repeated, later_s)
    return repeated


def _shift(message: Message, by_s: float) -> None:
    """Shift the stamp of a message by ``by_s``. Only the IMU's counter has more than 32 bits."""
    if hasattr(message, "time_boot_ms"):
        message.time_boot_ms = (message.time_boot_ms + round(1e3 * by_s)) % 2**32
    else:
        bits = 64 if message.get_type() in ("RAW_IMU", "HIGHRES_IMU") else 32
        message.time_usec = (message.time_usec + round(1e6 * by_s)) % 2**bits


def _in_g(raw: Message) -> Message:
    """Return HIGHRES_IMU with the accelerations of RAW_IMU, in g instead of m/s²."""
    force = [1e-3 * value for value in (raw.xacc, raw.yacc, raw.zacc)]
    gyro = [1e-3 * value for value in (raw.xgyro, raw.ygyro, raw.zgyro)]
    return mavlink.MAVLink_highres_imu_message(
        raw.time_usec, *force, *gyro, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 20.0, 0b111111
    )


def _int16(value: float) -> int:
    return min(max(round(value), -32768), 32767)
