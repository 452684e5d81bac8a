"""ArduPilot's own log (``.bin``): records and the bits of LOG_BITMASK."""

from collections.abc import Sequence
from dataclasses import dataclass

from advisor.words.mends.mends import GOOD_HZ, Mends


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
