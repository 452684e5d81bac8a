"""PX4's own log (``.ulg``): topics and the bits of SDLOG_PROFILE."""

from collections.abc import Mapping, Sequence

from advisor.words.mends.mends import Mends

_TOPICS = {
    "ATTITUDE": "vehicle_angular_velocity",
    "VFR_HUD": "airspeed",
    "SERVO_OUTPUT_RAW": "actuator_outputs",
    "ACTUATOR_CONTROL_TARGET": "actuator_controls_0",
    "RAW_IMU": "sensor_combined",
    "HIGHRES_IMU": "sensor_combined",
    "GLOBAL_POSITION_INT": "vehicle_local_position",
    "AOA_SSA": "vehicle_local_position",
    "NAMED_VALUE_FLOAT": "debug_key_value",
}
"""Topic of PX4's log for each message. The climb rate of the position gives the angle of attack that PX4
lacks."""

_Bit = tuple[int, str]
_DEFAULT: _Bit = (0, "default set")
_REPLAY: _Bit = (1, "estimator replay")
_SYSTEM: _Bit = (3, "system identification")
_HIGH_RATE: _Bit = (4, "high rate")
_DEBUG: _Bit = (5, "debug")
_BITS: Mapping[str, tuple[_Bit, ...]] = {
    "ATTITUDE": (_HIGH_RATE, _SYSTEM),
    "RAW_IMU": (_HIGH_RATE, _SYSTEM),
    "HIGHRES_IMU": (_HIGH_RATE, _SYSTEM),
    "SERVO_OUTPUT_RAW": (_HIGH_RATE, _SYSTEM),
    "ACTUATOR_CONTROL_TARGET": (_HIGH_RATE, _SYSTEM),
    "VFR_HUD": (_REPLAY,),
    "NAMED_VALUE_FLOAT": (_DEBUG,),
}
"""Bits of SDLOG_PROFILE that log the topic of each message at full rate, the preferred bit first (PX4's
``logged_topics.cpp``).

With the bit for high rates, ``actuator_servos`` comes at full rate, and ``actuator_outputs`` stays at 10 Hz.
The set for system identification has ``vehicle_torque_setpoint`` at full rate.
"""


class Ulog(Mends):
    """Topics of PX4's own log.

    Parameters
    ----------
    profile
        Value of SDLOG_PROFILE in the log; None if unknown. No advice names a bit that is already set.
    """

    names = _TOPICS

    def __init__(self, profile: int | None = None) -> None:
        self._profile = profile

    def faster(self, message: str) -> str:
        """Return the bit that logs the topic at its full rate."""
        return self._advice(_BITS.get(message, (_DEFAULT,)), self.called(message))

    def present(self, messages: Sequence[str]) -> str:
        """Return the bits that log the given topics."""
        wanted = [_DEBUG if _BITS.get(m) == (_DEBUG,) else _DEFAULT for m in messages]
        bits = [bit for bit in dict.fromkeys(wanted) if not self._has(bit)]
        topics = " and ".join(dict.fromkeys(self.called(message) for message in messages))
        if not bits:
            return f"{self._set()} already logs {topics}: find out why the vehicle does not publish them"
        return f"set {' and '.join(map(_bit, bits))}, so that {topics} are logged"

    def _advice(self, bits: Sequence[_Bit], topic: str) -> str:
        free = [bit for bit in bits if not self._has(bit)]
        if free:
            return f"set {_bit(free[0])}"
        return f"{self._set()} already logs {topic} as fast as it comes: use a faster card, or log less"

    def _has(self, bit: _Bit) -> bool:
        return self._profile is not None and bool(self._profile >> bit[0] & 1)

    def _set(self) -> str:
        return f"SDLOG_PROFILE {self._profile}"


def _bit(bit: _Bit) -> str:
    number, name = bit
    return f"bit {number} of SDLOG_PROFILE ({name}, {1 << number})"
