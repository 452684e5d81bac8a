"""Telemetry: the streams of a link, live or recorded as a ``.tlog``."""

from advisor.words.mends.mends import GOOD_HZ, Mends

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
