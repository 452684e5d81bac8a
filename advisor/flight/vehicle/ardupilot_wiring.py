"""Roles and scales of servo outputs from ArduPilot's parameters SERVOn_*."""

from advisor.flight.vehicle.surfaces import Scale
from advisor.flight.vehicle.wiring import AILERON, ELEVATOR, RUDDER, Parameters, Role, Wiring, Words

PREFIXES = ("SERVO",)
"""Beginnings of these parameters' names."""
_OUTPUTS = range(1, 33)
_ROLES = {
    4: AILERON,
    19: ELEVATOR,
    21: RUDDER,
    77: Role("elevon", "left"),
    78: Role("elevon", "right"),
    79: Role("V-tail", "left"),
    80: Role("V-tail", "right"),
    16: Role("differential spoiler", "left"),
    86: Role("differential spoiler", "left"),
    17: Role("differential spoiler", "right"),
    87: Role("differential spoiler", "right"),
}
"""Values of SERVOn_FUNCTION, ArduPilot's SRV_Channel.h."""

WORDS = Words(
    function="SERVOn_FUNCTION",
    elevator="SERVOn_FUNCTION 19",
    limits="SERVOn_MIN/TRIM/MAX",
    trim="SERVOn_TRIM",
    sense="SERVO{n}_REVERSED",
    unknown="Nothing says which servo output is the elevator: no SERVOn_FUNCTION was received.",
    usual="on most ArduPlane aircraft 2",
)


def ardupilot_wiring(parameters: Parameters) -> Wiring:
    """Return the outputs by SERVOn_FUNCTION, MIN, TRIM, MAX and REVERSED, with ArduPilot's defaults where
    unknown."""
    functions = {n: parameters[f"SERVO{n}_FUNCTION"] for n in _OUTPUTS if f"SERVO{n}_FUNCTION" in parameters}
    default = Scale()
    return Wiring(
        WORDS,
        {n: _ROLES.get(int(function), Role("")) for n, function in functions.items()},
        {
            n: Scale(
                low_us=parameters.get(f"SERVO{n}_MIN", default.low_us),
                trim_us=parameters.get(f"SERVO{n}_TRIM", default.trim_us),
                high_us=parameters.get(f"SERVO{n}_MAX", default.high_us),
                reversed=bool(parameters.get(f"SERVO{n}_REVERSED", 0.0)),
            )
            for n in _OUTPUTS
        },
        frozenset(n for n in _OUTPUTS if f"SERVO{n}_REVERSED" in parameters),
    )
