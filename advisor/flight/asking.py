"""How to get a message, or get it faster, said for the link or log at hand.

Stream rates bring nothing into a log that the autopilot writes itself, and LOG_BITMASK nothing onto a link.
"""

from dataclasses import dataclass

from advisor.flight.surfaces import listed
from advisor.flight.vehicle import Vehicle

GOOD_HZ = 50
"""Rate to ask for: it serves every aircraft that a telemetry link can follow."""

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


@dataclass(frozen=True, slots=True)
class _Record:
    """What an autopilot's own log has in place of a message."""

    name: str
    bit: int
    bit_name: str
    paced: str
    """What sets its rate."""


_DATAFLASH = {
    "ATTITUDE": _Record("IMU", 7, "IMU", "the main loop's rate"),
    "RAW_IMU": _Record("IMU", 7, "IMU", "the main loop's rate"),
    "HIGHRES_IMU": _Record("IMU", 7, "IMU", "the main loop's rate"),
    "SERVO_OUTPUT_RAW": _Record("RCOU", 13, "RC", "25 Hz, older firmware at 10 Hz"),
    "AOA_SSA": _Record("AOA", 0, "ATTITUDE_FAST", "10 Hz"),
    "VFR_HUD": _Record("ARSP", 7, "IMU", "10 Hz"),
}
"""ArduPlane's records, the bits of LOG_BITMASK that log them (ArduPlane/defines.h), and their rates
(ArduPlane.cpp: update_logging10, update_logging25)."""
_ULOG = {
    "ATTITUDE": "vehicle_angular_velocity",
    "RAW_IMU": "sensor_combined",
    "HIGHRES_IMU": "sensor_combined",
    "SERVO_OUTPUT_RAW": "actuator_outputs",
    "AOA_SSA": "airspeed_validated",
    "VFR_HUD": "airspeed_validated",
}
_SDLOG2 = {
    "ATTITUDE": "ATT",
    "RAW_IMU": "IMU",
    "HIGHRES_IMU": "IMU",
    "SERVO_OUTPUT_RAW": "OUT0",
    "AOA_SSA": "AIRS",
    "VFR_HUD": "AIRS",
}
_NAMES = {
    "dataflash": {message: record.name for message, record in _DATAFLASH.items()},
    "ulog": _ULOG,
    "sdlog2": _SDLOG2,
}
"""What each kind of log calls the records that stand for a message."""
_HIGH_RATE = 4
"""Bit of SDLOG_PROFILE, "high rate" (PX4: logger parameters)."""


def name_at_hand(message: str, vehicle: Vehicle) -> str:
    """The message as the user finds it: the record or topic of a log that the autopilot wrote."""
    return _NAMES.get(vehicle.carrier, {}).get(message, message)


def how_to_get(messages: list[str], vehicle: Vehicle) -> str:
    """How messages that never came are brought into the next log or onto the link; no full stop.

    Parameters
    ----------
    messages
        Names of MAVLink messages, whatever carries them.
    vehicle
        Who lacks them.
    """
    if vehicle.carrier == "dataflash":
        records = [_DATAFLASH[m] for m in messages]
        bits = dict.fromkeys(f"{r.name} by bit {r.bit} ({r.bit_name})" for r in records)
        return f"set LOG_BITMASK so that these are logged: {listed(list(bits))}; its default, 65535, has all"
    names = listed(list(dict.fromkeys(name_at_hand(message, vehicle) for message in messages)))
    if vehicle.carrier == "ulog":
        return f"set bit 0 (default) of SDLOG_PROFILE, which logs {names}"
    if vehicle.carrier == "sdlog2":
        return f"set SDLOG_EXT to 1, so that sdlog2 logs {names}"
    return f"ask for {listed(messages)} (run live with --request-rates)"


def how_to_speed_up(message: str, vehicle: Vehicle) -> str:
    """What to set on this autopilot so that a message comes faster; no full stop."""
    if vehicle.carrier == "dataflash" and message in _DATAFLASH:
        record = _DATAFLASH[message]
        return (
            f"LOG_BITMASK logs {record.name} at {record.paced} (bit {record.bit}, {record.bit_name}); for "
            f"more record a telemetry log with {message} at {GOOD_HZ} Hz"
        )
    if vehicle.carrier == "ulog":
        topic = name_at_hand(message, vehicle)
        return f"set bit {_HIGH_RATE} (high rate) of SDLOG_PROFILE, which logs {topic} faster"
    if vehicle.carrier == "sdlog2":
        return f"set SDLOG_RATE to {GOOD_HZ}, at which sdlog2 logs {name_at_hand(message, vehicle)}"
    number = f"message {_IDS[message]}, " if message in _IDS else ""
    request = f"run live with --request-rates ({number}{1_000_000 // GOOD_HZ} us interval)"
    if vehicle.autopilot == "px4":
        return f"set mavlink stream -s {message} -r {GOOD_HZ} in the start-up script or {request}"
    group = _STREAM_GROUPS.get(message)
    if vehicle.autopilot != "ardupilot" or group is None:
        return f"raise the rate of {message} at its sender to {GOOD_HZ} Hz, or {request}"
    return (
        f"set SR0_{group} (MAV1_{group}) to {GOOD_HZ}, counted up by one for every further telemetry port, "
        f"or {request}"
    )
