"""Mixing of servo outputs into aileron, elevator, rudder and flap, with one row per function.

An output is a share of its travel and rises with its demand. A control is the weighted sum of its servo
outputs. The weights invert the mixer, so that every other demand cancels.

ArduPlane: ``servos.cpp`` (channel_function_mixer, flaperon_update, dspoiler_update) and ``SRV_Channel.h``.
PX4 since 1.13: the rules in ``control_allocator/module.yaml``. PX4 counts horizontal and mixed surfaces
positive upwards, and vertical ones positive to the right.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

Control = Literal["elevator", "aileron", "rudder", "flap"]


@dataclass(frozen=True, slots=True)
class Role:
    """Surface that an output moves, with the output's weight in each control."""

    surface: str
    """``elevator``, ``aileron``, ``rudder``, ``flap``, or the name of a mixed pair."""
    side: str = ""
    """Member of a mixed pair; empty for a plain surface."""
    elevator: float = 0.0
    aileron: float = 0.0
    rudder: float = 0.0
    flap: float = 0.0

    def weight(self, control: Control) -> float:
        """Return the weight of the output in a control; 0 if the control's demand does not move it."""
        return float(getattr(self, control))

    @property
    def is_mixed(self) -> bool:
        """Whether the output responds to several demands."""
        return bool(self.side)


NOTHING = Role("")
"""Role of an output that moves no control surface."""
ELEVATOR = Role("elevator", elevator=1.0)
AILERON = Role("aileron", aileron=1.0)
RUDDER = Role("rudder", rudder=1.0)
FLAP = Role("flap", flap=1.0)


def _pair(surface: str, left: Mapping[str, float], right: Mapping[str, float]) -> tuple[Role, Role]:
    return Role(surface, "left", **left), Role(surface, "right", **right)


def _spoilers(
    surface: str, outer: Mapping[str, float], inner: Mapping[str, float]
) -> tuple[Role, Role, Role, Role]:
    """Return rows of outer and inner spoilers, left then right; left has opposite signs of roll and yaw."""
    mirrored = [
        {control: value if control == "elevator" else -value for control, value in row.items()}
        for row in (outer, inner)
    ]
    return (
        Role(surface, "outer left", **mirrored[0]),
        Role(surface, "inner left", **mirrored[1]),
        Role(surface, "outer right", **outer),
        Role(surface, "inner right", **inner),
    )


ELEVONS = _pair("elevon", {"elevator": 0.5, "aileron": -0.5}, {"elevator": 0.5, "aileron": 0.5})
V_TAIL = _pair("V-tail", {"elevator": 0.5, "rudder": 0.5}, {"elevator": 0.5, "rudder": -0.5})
A_TAIL = _pair("A-tail", {"elevator": 0.5, "rudder": -0.5}, {"elevator": 0.5, "rudder": 0.5})
FLAPERONS = _pair("flaperon", {"aileron": 0.5, "flap": 0.5}, {"aileron": 0.5, "flap": -0.5})
"""ArduPlane writes aileron + flap to the left and aileron - flap to the right."""
SPOILERS = _spoilers(
    "differential spoiler",
    {"elevator": 0.25, "aileron": 0.25, "rudder": 0.5},
    {"elevator": 0.25, "aileron": 0.25, "rudder": -0.5},
)
"""Elevons of full span, each divided into two halves. A rudder demand opens the two halves of one wing."""
PART_SPAN_SPOILERS = _spoilers(
    "part-span differential spoiler",
    {"elevator": 0.5, "aileron": 0.5},
    {"elevator": 0.5, "aileron": 0.5, "rudder": -1.0},
)
"""Differential spoilers whose outer halves alone are elevons. A demand in roll or pitch does not move the
inner halves, which follow only the rudder demand.
"""
OUTER_SPOILERS = _pair(
    "outer differential spoiler", {"elevator": 0.5, "aileron": -0.5}, {"elevator": 0.5, "aileron": 0.5}
)
"""Outer halves of differential spoilers without inner halves. The mean of both wings' outer halves reads an
opening for yaw as pitch.
"""

ROWS: tuple[Role, ...] = (
    *(ELEVATOR, AILERON, RUDDER, FLAP),
    *(*ELEVONS, *V_TAIL, *A_TAIL, *FLAPERONS, *SPOILERS, *PART_SPAN_SPOILERS, *OUTER_SPOILERS),
)
"""All rows of the mixers' table."""

_ARDUPLANE: Mapping[int, Role] = {
    2: FLAP,
    3: FLAP,
    4: AILERON,
    19: ELEVATOR,
    21: RUDDER,
    24: FLAPERONS[0],
    25: FLAPERONS[1],
    77: ELEVONS[0],
    78: ELEVONS[1],
    79: V_TAIL[0],
    80: V_TAIL[1],
}
"""Row of the output for each value of SERVOn_FUNCTION."""
_SPOILER_FUNCTIONS = (16, 86, 17, 87)
"""Values of SERVOn_FUNCTION for outer left, inner left, outer right, inner right."""
_FLYING_WING, _FULL_SPAN = 1, 2
"""Bits of DSPOILER_OPTS: the spoilers also pitch, and the inner halves also follow roll and pitch."""
_USUAL_OPTIONS = _FLYING_WING | _FULL_SPAN
"""ArduPlane's default of DSPOILER_OPTS."""

Torque = tuple[float, float, float]
"""Signs of the torques in roll, pitch and yaw for a positive command."""
PX4: Mapping[int, tuple[Role, Torque]] = {
    1: (AILERON, (-1.0, 0.0, 0.0)),
    2: (AILERON, (1.0, 0.0, 0.0)),
    3: (ELEVATOR, (0.0, 1.0, 0.0)),
    4: (RUDDER, (0.0, 0.0, 1.0)),
    5: (ELEVONS[0], (-1.0, 1.0, 0.0)),
    6: (ELEVONS[1], (1.0, 1.0, 0.0)),
    7: (V_TAIL[0], (0.0, 1.0, 1.0)),
    8: (V_TAIL[1], (0.0, 1.0, -1.0)),
    9: (FLAP, (0.0, 0.0, 0.0)),
    10: (FLAP, (0.0, 0.0, 0.0)),
    13: (A_TAIL[0], (0.0, 1.0, -1.0)),
    14: (A_TAIL[1], (0.0, 1.0, 1.0)),
    15: (AILERON, (1.0, 0.0, 0.0)),
}
"""Row of the surface and its usual torque for each value of CA_SV_CSn_TYPE."""


def arduplane_roles(functions: Mapping[int, int], spoiler_options: int | None) -> dict[int, Role]:
    """Return the role of each output.

    Parameters
    ----------
    functions
        SERVOn_FUNCTION of each output, by the output's number.
    spoiler_options
        Value of DSPOILER_OPTS; None if unknown.
    """
    spoilers = _spoiler_rows(set(functions.values()), spoiler_options)
    return {n: spoilers.get(value) or _ARDUPLANE.get(value, NOTHING) for n, value in functions.items()}


def _spoiler_rows(assigned: set[int], options: int | None) -> dict[int, Role]:
    bits = _USUAL_OPTIONS if options is None else options
    rows = dict(zip(_SPOILER_FUNCTIONS, SPOILERS if bits & _FULL_SPAN else PART_SPAN_SPOILERS, strict=True))
    if not assigned & {86, 87}:
        rows = {16: OUTER_SPOILERS[0], 17: OUTER_SPOILERS[1]}
    return rows if bits & _FLYING_WING else {n: replace(row, elevator=0.0) for n, row in rows.items()}


def sides_of(surface: str, control: Control) -> set[str]:
    """Return the members of a pair that a control needs; a plain surface has one empty name."""
    return {row.side for row in ROWS if row.surface == surface and row.weight(control)}
