"""ArduPilot's own log (``.bin``): records and the bits of LOG_BITMASK."""

from collections.abc import Sequence

_RECORDS = {
    "ATTITUDE": "ATT",
    "AOA_SSA": "AOA",
    "VFR_HUD": "ARSP",
    "SERVO_OUTPUT_RAW": "RCOU",
    "RAW_IMU": "IMU",
    "HIGHRES_IMU": "IMU",
    "GLOBAL_POSITION_INT": "POS",
}


class Dataflash:
    """Records of ArduPlane's log."""

    def called(self, message: str) -> str:
        """The record."""
        return _RECORDS.get(message, message)

    def faster(self, message: str) -> str:
        """The bits that log at the main loop's rate."""
        return f"set LOG_BITMASK so that {self.called(message)} is logged fast"

    def present(self, messages: Sequence[str]) -> str:
        """The bits that log the records at all."""
        listed = " and ".join(dict.fromkeys(self.called(message) for message in messages))
        return f"set LOG_BITMASK so that {listed} are logged"
