"""How to get a message faster: what to set, in both of ArduPilot's spellings, and what to ask for."""

from collections.abc import Mapping

GOOD_HZ = 50

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
"""ArduPilot's stream groups, GCS_MAVLink: the suffix of the parameter that holds their rate."""

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


def how_to_ask(message: str, autopilot: str) -> str:
    """One sentence: what to set on this autopilot, and what to request over the link.

    Parameters
    ----------
    message
        Message name.
    autopilot
        ``ardupilot``, ``px4``, or another.
    """
    number = f"message {_IDS[message]}, " if message in _IDS else ""
    request = f"run with --request-rates ({number}{1_000_000 // GOOD_HZ} us interval)"
    if autopilot == "px4":
        return f"set mavlink stream -s {message} -r {GOOD_HZ} in the start-up script or {request}"
    group = _STREAM_GROUPS.get(message)
    if group is None:
        return f"raise the rate of {message} at its sender to {GOOD_HZ} Hz"
    return (
        f"set SR0_{group} (MAV1_{group}) to {GOOD_HZ}, counted up by one for every further telemetry port, "
        f"or {request}"
    )


def table(messages: Mapping[str, float]) -> str:
    """Messages and rates in words: ``ATTITUDE 4.0 Hz, AOA_SSA 4.0 Hz``."""
    return ", ".join(f"{name} {rate_hz:.1f} Hz" for name, rate_hz in messages.items())
