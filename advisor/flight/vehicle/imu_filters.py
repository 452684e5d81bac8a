"""Delay of an autopilot's own filters of gyro and accelerometer, as its parameters state them.

Below its cut-off f a second-order Butterworth low-pass delays every motion by √2/(2πf): 11 ms at 20 Hz. A
notch of width b at f adds b/(2πf²). The short period is far below both frequencies."""

from collections.abc import Mapping
from math import pi, sqrt

PREFIXES = ("INS_GYRO_FILTER", "INS_ACCEL_FILTER", "INS_HNTCH_", "IMU_GYRO_CUTOFF", "IMU_ACCEL_CUTOFF")
"""Beginnings of these parameters' names."""
_USUAL_HZ = 20.0
"""Cut-off of ArduPlane's gyro and accelerometer filters, Hz, where no parameter states another."""
_RATES = ("p", "q", "r")
_FORCES = ("a_x", "a_y", "a_z")
_PARAMETER = {
    ("ardupilot", True): "INS_GYRO_FILTER",
    ("ardupilot", False): "INS_ACCEL_FILTER",
    ("px4", True): "IMU_GYRO_CUTOFF",
    ("px4", False): "IMU_ACCEL_CUTOFF",
}
"""Autopilot, and whether the channel is a rate, to the parameter that states the filter's cut-off, Hz."""
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
        return _low_pass_s(stated.get(_PARAMETER[autopilot, channel in _RATES], 0.0))
    if autopilot != "ardupilot":
        return 0.0
    low_pass_s = _low_pass_s(stated.get(_PARAMETER[autopilot, channel in _RATES], _USUAL_HZ))
    return low_pass_s + (_notch_s(stated) if channel in _RATES else 0.0)


def states_filter(channel: str, autopilot: str, stated: Mapping[str, float]) -> bool:
    """Return whether a parameter states the filter of a channel; the arguments are those of
    ``filter_delay_s``."""
    return channel in _RATES + _FORCES and _PARAMETER.get((autopilot, channel in _RATES)) in stated


def _low_pass_s(cutoff_hz: float) -> float:
    """Return the delay of a second-order Butterworth filter; a cut-off of 0 switches the filter off."""
    return sqrt(2.0) / (2.0 * pi * cutoff_hz) if cutoff_hz > 0.0 else 0.0


def _notch_s(stated: Mapping[str, float]) -> float:
    """Return the delay of ArduPilot's first harmonic notch."""
    centre, width = stated.get("INS_HNTCH_FREQ", 0.0), stated.get("INS_HNTCH_BW", 0.0)
    if not stated.get("INS_HNTCH_ENABLE", 0.0) or centre <= 0.0:
        return 0.0
    return width / (2.0 * pi * centre**2)
