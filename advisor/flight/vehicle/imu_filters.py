"""Delay of an autopilot's own filters of gyro and accelerometer, as its parameters state them.

A filter that no parameter states is unknown. Its delay then is part of the delay of the command and of the
angle of attack, which the fit estimates with priors.

Below its cut-off f a second-order Butterworth low-pass delays every motion by √2/(2πf): 11 ms at 20 Hz. A
notch of width b at f adds b/(2πf²). The short period is far below both frequencies."""

from collections.abc import Mapping
from math import pi, sqrt

PREFIXES = ("INS_GYRO_FILTER", "INS_ACCEL_FILTER", "INS_HNTCH_", "IMU_GYRO_CUTOFF", "IMU_ACCEL_CUTOFF")
"""Beginnings of these parameters' names."""
_RATES = ("p", "q", "r")
_FORCES = ("a_x", "a_y", "a_z")
_UNFILTERED_ON_PX4 = "HIGHRES_IMU"
"""Message of PX4 that comes from the integrals of the sensors, without a filter."""


def filter_delay_s(channel: str, source: str, autopilot: str, stated: Mapping[str, float]) -> float:
    """Return the known delay of a channel by the autopilot's filters, s; 0 where none is known.

    Parameters
    ----------
    channel, source
        Name of the channel, and its message and field.
    autopilot
        Name of the autopilot in the vehicle's identity.
    stated
        Parameter name to its value.
    """
    if channel not in _RATES + _FORCES:
        return 0.0
    if autopilot == "px4":
        if source.startswith(_UNFILTERED_ON_PX4):
            return 0.0
        cutoff = stated.get("IMU_GYRO_CUTOFF" if channel in _RATES else "IMU_ACCEL_CUTOFF", 0.0)
        return _low_pass_s(cutoff)
    if autopilot != "ardupilot":
        return 0.0
    if channel in _FORCES:
        return _low_pass_s(stated.get("INS_ACCEL_FILTER", 0.0))
    return _low_pass_s(stated.get("INS_GYRO_FILTER", 0.0)) + _notch_s(stated)


def _low_pass_s(cutoff_hz: float) -> float:
    """Return the delay of a second-order Butterworth filter; a cut-off of 0 switches the filter off."""
    return sqrt(2.0) / (2.0 * pi * cutoff_hz) if cutoff_hz > 0.0 else 0.0


def _notch_s(stated: Mapping[str, float]) -> float:
    """Return the delay of ArduPilot's first harmonic notch."""
    centre, width = stated.get("INS_HNTCH_FREQ", 0.0), stated.get("INS_HNTCH_BW", 0.0)
    if not stated.get("INS_HNTCH_ENABLE", 0.0) or centre <= 0.0:
        return 0.0
    return width / (2.0 * pi * centre**2)
