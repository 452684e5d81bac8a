"""Remedies for a record with missing or slow data. Each remedy uses the autopilot's own names.

The data of a vehicle come over telemetry, live or from a ``.tlog``, or from the autopilot's own log.
Each kind of sender has other names for the values, and other settings for their rates.
"""

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal

Carrier = Literal["telemetry", "dataflash", "ulog", "table"]
"""Kind of record: a link or its ``.tlog``, ArduPilot's ``.bin``, PX4's ``.ulg``, or a table with named
columns."""
GOOD_HZ = 50
"""Message rate that the remedies recommend, 1/s. One period of a short-period mode of 2 Hz, typical of a
small UAV, then has 25 samples.
"""


class Mends:
    """Names of values in one kind of record, and the settings that raise their rates.

    A message has its MAVLink name, because the advisor reads every record as MAVLink messages.
    """

    names: ClassVar[Mapping[str, str]] = {}
    """Name in this kind of log of each MAVLink message, if that name differs from the message's."""

    def called(self, message: str) -> str:
        """Return the name of a message's values in this kind of record."""
        return self.names.get(message, message)

    @abstractmethod
    def faster(self, message: str) -> str:
        """Return the remedy for a slow message, as a clause without a full stop: how to obtain the message at
        ``GOOD_HZ``.
        """

    def present(self, messages: Sequence[str]) -> str:
        """Return the remedy for absent messages, as a clause without a full stop. The default is a request on
        the link.
        """
        return f"ask for {' and '.join(map(self.called, messages))} (--request-rates)" if messages else ""


def sentence(clause: str, end: str = ".") -> str:
    """Return a clause as a sentence with a capital letter and the given end."""
    return clause[:1].upper() + clause[1:] + end


_COLUMNS = {
    "ATTITUDE": "q, p, r, theta",
    "RAW_IMU": "a_x, a_y, a_z",
    "HIGHRES_IMU": "a_x, a_y, a_z",
    "SERVO_OUTPUT_RAW": "elevator, aileron, rudder",
    "AOA_SSA": "alpha, beta",
    "NAMED_VALUE_FLOAT": "alpha, beta",
    "VFR_HUD": "airspeed, height",
}


class Table(Mends):
    """Columns of a table."""

    names = _COLUMNS

    def faster(self, message: str) -> str:
        """Return the rate of the table's rows."""
        return f"write the table with {GOOD_HZ} rows a second, for {self.called(message)}"

    def present(self, messages: Sequence[str]) -> str:
        """Return the keys of the aircraft file that name the table's columns."""
        named = ", ".join(dict.fromkeys(self.called(message) for message in messages))
        return f"name the columns in the aircraft file (columns: {named})"


@dataclass(frozen=True, slots=True)
class _Record:
    """Record of ArduPilot's log that contains the values of a message."""

    name: str
    bit: int
    bit_name: str
    paced: str
    """Rate at which the record is written, or the loop that sets this rate."""


_IMU = _Record("IMU", 7, "IMU", "the main loop's rate")
_RECORDS = {
    "ATTITUDE": _IMU,
    "RAW_IMU": _IMU,
    "HIGHRES_IMU": _IMU,
    "SERVO_OUTPUT_RAW": _Record("RCOU", 13, "RC", "25 Hz (10 Hz in older firmware)"),
    "AOA_SSA": _Record("AOA", 0, "ATTITUDE_FAST", "10 Hz"),
    "VFR_HUD": _Record("ARSP", 7, "IMU", "10 Hz"),
}
"""ArduPlane's record for each MAVLink message. A record has its bit of LOG_BITMASK (ArduPlane/defines.h) and
its rate (ArduPlane.cpp: update_logging10, update_logging25).
"""
_NAMES = {message: record.name for message, record in _RECORDS.items()}


class Dataflash(Mends):
    """Records of ArduPlane's log."""

    names = _NAMES

    def faster(self, message: str) -> str:
        """Return the rate of the record in the log, and the kind of log that has a higher rate."""
        record = _RECORDS.get(message)
        logged = (
            f"LOG_BITMASK logs {record.name} at {record.paced} (bit {record.bit}, {record.bit_name}); "
            if record
            else ""
        )
        return f"{logged}for a higher rate, record a telemetry log with {message} at {GOOD_HZ} Hz"

    def present(self, messages: Sequence[str]) -> str:
        """Return the bits of LOG_BITMASK that log the given records."""
        records = [_RECORDS[message] for message in messages if message in _RECORDS]
        bits = dict.fromkeys(f"{record.name} by bit {record.bit} ({record.bit_name})" for record in records)
        return f"set LOG_BITMASK so that these are logged: {', '.join(bits)}; its default, 65535, has all"


_STREAM_GROUPS = {
    "ATTITUDE": "EXTRA1",
    "AOA_SSA": "EXTRA1",
    "VFR_HUD": "EXTRA2",
    "SERVO_OUTPUT_RAW": "RC_CHAN",
    "RAW_IMU": "RAW_SENS",
    "SCALED_IMU": "RAW_SENS",
    "SCALED_IMU2": "RAW_SENS",
    "GLOBAL_POSITION_INT": "POSITION",
}
"""ArduPilot's stream group (GCS_MAVLink) of each message. The group's name ends the name of the parameter
that holds the rate.
"""

_IDS = {
    "SCALED_IMU": 26,
    "RAW_IMU": 27,
    "ATTITUDE": 30,
    "GLOBAL_POSITION_INT": 33,
    "SERVO_OUTPUT_RAW": 36,
    "VFR_HUD": 74,
    "HIGHRES_IMU": 105,
    "NAMED_VALUE_FLOAT": 251,
    "ACTUATOR_OUTPUT_STATUS": 375,
    "AOA_SSA": 11020,
}

_PX4_NAMES = {"RAW_IMU": "HIGHRES_IMU"}
_PX4_STREAMS = {"SERVO_OUTPUT_RAW": "SERVO_OUTPUT_RAW_0", "RAW_IMU": "HIGHRES_IMU"}
"""PX4 stream of each message, if the names differ (PX4's ``mavlink_messages.cpp``)."""


def _request(message: str) -> str:
    number = f"message {_IDS[message]}, " if message in _IDS else ""
    return f"run with --request-rates ({number}{1_000_000 // GOOD_HZ} us interval)"


class ArduPilotTelemetry(Mends):
    """ArduPilot's streams. One parameter sets the rate of each group of messages."""

    def faster(self, message: str) -> str:
        """Return the remedy: the rate parameter of the stream group, in both spellings, or a request."""
        group = _STREAM_GROUPS.get(message)
        if group is None:
            return f"raise the rate of {message} at its sender to {GOOD_HZ} Hz"
        return (
            f"set SR0_{group} (MAV1_{group}) to {GOOD_HZ}, counted up by one for every further telemetry "
            f"port, or {_request(message)}"
        )


class Px4Telemetry(Mends):
    """PX4's streams. Each stream has a rate, and the limit of the link bounds all streams together."""

    names = _PX4_NAMES

    def faster(self, message: str) -> str:
        """Return the remedy: the command of PX4's shell that sets the rate, or a request."""
        stream = _PX4_STREAMS.get(message, message)
        return (
            f"set mavlink stream -d DEVICE -s {stream} -r {GOOD_HZ} in etc/extras.txt on the SD card, with "
            f"MAV_0_RATE high enough for the link (MAV_0_MODE Onboard sends more than Normal); "
            f"or {_request(self.called(message))}"
        )


class OtherTelemetry(Mends):
    """Streams of an autopilot with unknown parameters."""

    def faster(self, message: str) -> str:
        """Return a request for a higher rate of the message."""
        return f"raise the rate of {message} on the vehicle to {GOOD_HZ} Hz, or {_request(message)}"


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


def mends_of(autopilot: str, carrier: Carrier, log_profile: int | None = None) -> Mends:
    """Return the remedies for a vehicle.

    Parameters
    ----------
    autopilot
        ``ardupilot``, ``px4``, or another name.
    log_profile
        Value of SDLOG_PROFILE in a PX4 log; None if unknown.
    """
    if carrier == "dataflash":
        return Dataflash()
    if carrier == "ulog":
        return Ulog(log_profile)
    if carrier == "table":
        return Table()
    telemetry: dict[str, Mends] = {"ardupilot": ArduPilotTelemetry(), "px4": Px4Telemetry()}
    return telemetry.get(autopilot, OtherTelemetry())
