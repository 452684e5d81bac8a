"""Roles and scales of servo outputs from ArduPilot's parameters SERVOn_*.

A servo output can pass a radio channel through. Function 1 passes the output's own channel unscaled, and
function 50 + k passes channel k unscaled. Function 139 + k passes radio channel k, scaled to the output's
travel. Without an output with the control's function, the output that passes its stick through is the
control.
"""

from collections.abc import Mapping

from advisor.flight.vehicle.mixers import AILERON, ELEVATOR, RUDDER, Control, Role, arduplane_roles
from advisor.flight.vehicle.surfaces import Parameters, Scale, Wiring, Words, limits, listed

_CHANNELS = range(1, 17)
PREFIXES = ("SERVO", "RCMAP_", "DSPOILER_OPTS", *(f"RC{k}_REVERSED" for k in _CHANNELS))
"""Beginnings of the names of ArduPilot's parameters about servo outputs."""
_OUTPUTS = range(1, 33)
_PASSES_OWN = 1
_PASSES_RAW, _PASSES_SCALED = 50, 139
"""Value of SERVOn_FUNCTION minus k for an output that passes radio channel k, unscaled or scaled."""
_STICKS: Mapping[Control, tuple[str, int, Role]] = {
    "aileron": ("RCMAP_ROLL", 1, AILERON),
    "elevator": ("RCMAP_PITCH", 2, ELEVATOR),
    "rudder": ("RCMAP_YAW", 4, RUDDER),
}
"""Parameter of each stick's radio channel, its default, and the role of an output that passes the stick."""

WORDS = Words(
    function="SERVOn_FUNCTION",
    elevator="SERVOn_FUNCTION 19",
    limits="SERVOn_MIN/TRIM/MAX",
    trim="SERVOn_TRIM",
    sense="SERVO{n}_REVERSED",
    unknown="The elevator's servo output is unknown: no SERVOn_FUNCTION was received.",
    usual="on most ArduPlane aircraft 2",
)


def ardupilot_wiring(parameters: Parameters) -> Wiring:
    """Return the outputs by SERVOn_FUNCTION, MIN, TRIM, MAX and REVERSED, with ArduPilot's defaults."""
    functions = {
        n: int(parameters[f"SERVO{n}_FUNCTION"]) for n in _OUTPUTS if f"SERVO{n}_FUNCTION" in parameters
    }
    passed = {n: k for n, value in functions.items() if (k := _passed_channel(n, value))}
    roles = arduplane_roles(functions, _whole(parameters.get("DSPOILER_OPTS")))
    sticks = _passing(roles, passed, parameters)
    raw = {n for n in sticks if not _is_scaled(functions[n])}
    senses = {n: f"RC{passed[n]}_REVERSED" if n in raw else f"SERVO{n}_REVERSED" for n in _OUTPUTS}
    scaled = {
        n: limits(
            (f"SERVO{n}_MIN", f"SERVO{n}_TRIM", f"SERVO{n}_MAX"),
            parameters,
            Scale(reversed=bool(parameters.get(senses[n], 0.0))),
        )
        for n in _OUTPUTS
    }
    pitching = sorted({f"radio channel {passed[n]}, passed through" for n in sticks if sticks[n] == ELEVATOR})
    return Wiring(
        WORDS,
        roles | sticks,
        {n: scale for n, (scale, _) in scaled.items()},
        frozenset(n for n in _OUTPUTS if senses[n] in parameters),
        assumed=listed(pitching),
        doubts={n: doubt for n, (_, doubt) in scaled.items() if doubt is not None},
        passed=passed,
    )


def _whole(value: float | None) -> int | None:
    return None if value is None else int(value)


def _is_scaled(function: int) -> bool:
    return function > _PASSES_SCALED


def _passed_channel(n: int, function: int) -> int:
    """Return the radio channel that output ``n`` passes through; 0 for any other function."""
    if function == _PASSES_OWN:
        return n
    channel = function - (_PASSES_SCALED if _is_scaled(function) else _PASSES_RAW)
    return channel if channel in _CHANNELS else 0


def _passing(roles: Mapping[int, Role], passed: Mapping[int, int], parameters: Parameters) -> dict[int, Role]:
    """Return the roles of outputs that pass a stick through, for controls without another output."""
    passing: dict[int, Role] = {}
    for control, (name, usual, role) in _STICKS.items():
        if not any(r.weight(control) for r in roles.values()):
            channel = int(parameters.get(name, usual))
            passing |= {n: role for n, k in passed.items() if k == channel}
    return passing
