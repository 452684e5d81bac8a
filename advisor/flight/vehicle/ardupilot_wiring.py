"""Roles and scales of servo outputs from ArduPilot's parameters SERVOn_*."""

from advisor.flight.vehicle.limits import limits
from advisor.flight.vehicle.surfaces import Scale
from advisor.flight.vehicle.wiring import AILERON, ELEVATOR, RUDDER, Parameters, Role, Wiring, Words

PREFIXES = ("SERVO",)
"""Beginnings of these parameters' names."""
_OUTPUTS = range(1, 33)
_ROLES = {
    4: AILERON,
    19: ELEVATOR,
    21: RUDDER,
    24: Role("flaperon", "left"),
    25: Role("flaperon", "right"),
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
    scaled = {
        n: limits(
            (f"SERVO{n}_MIN", f"SERVO{n}_TRIM", f"SERVO{n}_MAX"),
            parameters,
            Scale(reversed=bool(parameters.get(f"SERVO{n}_REVERSED", 0.0))),
        )
        for n in _OUTPUTS
    }
    return Wiring(
        WORDS,
        {n: _ROLES.get(int(function), Role("")) for n, function in functions.items()},
        {n: scale for n, (scale, _) in scaled.items()},
        frozenset(n for n in _OUTPUTS if f"SERVO{n}_REVERSED" in parameters),
        doubts={n: doubt for n, (_, doubt) in scaled.items() if doubt is not None},
    )
