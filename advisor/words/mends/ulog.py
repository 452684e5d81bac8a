"""PX4's own log (``.ulg``): topics and the bits of SDLOG_PROFILE."""

from collections.abc import Sequence

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
"""Message to its topic. The climb rate of the position gives the angle of attack that PX4 lacks."""

_DEFAULT, _REPLAY, _HIGH_RATE, _DEBUG = (
    (0, "default set"),
    (1, "estimator replay"),
    (4, "high rate"),
    (5, "debug"),
)
_BITS = {
    "ATTITUDE": _HIGH_RATE,
    "SERVO_OUTPUT_RAW": _HIGH_RATE,
    "ACTUATOR_CONTROL_TARGET": _HIGH_RATE,
    "VFR_HUD": _REPLAY,
    "NAMED_VALUE_FLOAT": _DEBUG,
}
"""Message to the bit of SDLOG_PROFILE that logs its topic at full rate (PX4's ``logged_topics.cpp``).

With the bit for high rates, ``actuator_servos`` comes at full rate, and ``actuator_outputs`` stays at 10 Hz.
"""


class Ulog:
    """Topics of PX4's log."""

    def called(self, message: str) -> str:
        """Return the name of the topic."""
        return _TOPICS.get(message, message)

    def faster(self, message: str) -> str:
        """Return the bit that logs the topic at its full rate."""
        return f"set {_bit(_BITS.get(message, _DEFAULT))}"

    def present(self, messages: Sequence[str]) -> str:
        """Return the bits that log the topics at all."""
        bits = dict.fromkeys(_BITS[m] if _BITS.get(m) == _DEBUG else _DEFAULT for m in messages)
        topics = " and ".join(dict.fromkeys(self.called(message) for message in messages))
        return f"set {' and '.join(map(_bit, bits))}, so that {topics} are logged"


def _bit(bit: tuple[int, str]) -> str:
    number, name = bit
    return f"bit {number} of SDLOG_PROFILE ({name}, {1 << number})"
