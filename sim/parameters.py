"""Parameters of the bundled vehicle, with ArduPilot's names."""

from collections.abc import Mapping

from pymavlink.dialects.v20 import ardupilotmega as mavlink

from .servo import Calibration

ELEVATOR_OUTPUT = 2

STREAM_GROUPS: Mapping[str, tuple[str, ...]] = {
    "RAW_SENS": ("RAW_IMU",),
    "EXT_STAT": (),
    "RC_CHAN": ("SERVO_OUTPUT_RAW",),
    "RAW_CTRL": (),
    "POSITION": ("GLOBAL_POSITION_INT",),
    "EXTRA1": ("ATTITUDE", "AOA_SSA"),
    "EXTRA2": ("VFR_HUD",),
    "EXTRA3": ("SYSTEM_TIME",),
    "PARAMS": (),
}
"""Messages that ArduPlane sends at the rate SRn_*, by the parameter's suffix."""

STREAM_OF_ID = {
    1: "RAW_SENS",
    2: "EXT_STAT",
    3: "RC_CHAN",
    4: "RAW_CTRL",
    6: "POSITION",
    10: "EXTRA1",
    11: "EXTRA2",
    12: "EXTRA3",
}
"""Stream group of each MAV_DATA_STREAM number in REQUEST_DATA_STREAM."""

FUNCTIONS = {1: 4, 2: 19, 3: 70, 4: 21}
"""SERVOn_FUNCTION of each servo output: aileron, elevator, throttle, rudder."""


def parameter_table(rates: Mapping[str, float], system: int, calibration: Calibration) -> dict[str, float]:
    """Return every parameter by name."""
    table: dict[str, float] = {}
    for output, function in FUNCTIONS.items():
        low, trim, high = calibration.low_us, calibration.trim_us, calibration.high_us
        if function == 70:
            trim = low
        table[f"SERVO{output}_FUNCTION"] = function
        table[f"SERVO{output}_MIN"] = low
        table[f"SERVO{output}_TRIM"] = trim
        table[f"SERVO{output}_MAX"] = high
        # ArduPilot's elevator pulls with more pulse width unless reversed; here more pulse width pushes.
        table[f"SERVO{output}_REVERSED"] = 1 if output == ELEVATOR_OUTPUT else 0
    for group, names in STREAM_GROUPS.items():
        table[f"SR0_{group}"] = round(max((rates.get(name, 0.0) for name in names), default=0.0))
    table["SYSID_THISMAV"] = system
    table["SYSID_MYGCS"] = 255
    return table


def parameter_type(name: str) -> int:
    """Return the MAV_PARAM_TYPE that ArduPilot gives the parameter."""
    if name.endswith("_REVERSED"):
        return int(mavlink.MAV_PARAM_TYPE_INT8)
    return int(mavlink.MAV_PARAM_TYPE_INT16)
