"""Test inputs that an autopilot flies: their steps or sines, lengths and controls.

Deflections have the aircraft file's signs. A positive elevator is trailing edge down, a positive aileron
rolls to the left, a positive rudder yaws to the left. The inputs begin with nose up or to the right, and
reverse inputs with nose down.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import ceil
from typing import Literal

from advisor.decision.inputs import SHORTEST_UNIT_S
from advisor.scripts.multisine import Multisine, disjoint_harmonics, multisine
from advisor.scripts.pace import Pace

Control = Literal["elevator", "aileron", "rudder"]
CONTROLS: tuple[Control, ...] = ("elevator", "aileron", "rudder")

Steps = tuple[tuple[float, float], ...]
"""Steps of one control: duration in time units, and share of the size."""

_3_2_1_1: Steps = ((3.0, -2.0 / 3.0), (2.0, 1.0), (1.0, -11.0 / 12.0), (1.0, 11.0 / 12.0))
"""The modified 3-2-1-1 of the paper, nose up first: steps of 0.8, 1.2, 1.1 and 1.1, divided by the largest.
Both pairs of steps have equal areas, so that the aircraft returns to trim without a pilot."""
_DOUBLET: Steps = ((1.0, -1.0), (1.0, 1.0))
_1_2_1: Steps = ((1.0, -1.0), (2.0, 1.0), (1.0, -1.0))

STEPPED: Mapping[str, tuple[Control, Steps]] = {
    "3-2-1-1": ("elevator", _3_2_1_1),
    "reverse 3-2-1-1": ("elevator", tuple((units, -share) for units, share in _3_2_1_1)),
    "aileron doublet": ("aileron", _DOUBLET),
    "rudder doublet": ("rudder", _DOUBLET),
    "aileron 1-2-1": ("aileron", _1_2_1),
}
"""Control and steps of each stepped input, by its name."""
MULTISINE = "multisine"
NAMES = (*STEPPED, MULTISINE)
"""Names of all inputs, in the order of a script's table."""

_SHORTEST_AILERON_S = 0.5
"""Shortest step of the aileron, s. A shorter step of a fast roll gives no visible bank."""
_EVEN_S = 0.02
"""Grid of the time units, s. An autopilot renews its outputs every 20 ms or faster."""
_SHORTEST_REST_S = 2.0
"""Shortest hands-off flight after an input, s. Trim and noise are visible after the motion."""
_BAND = (0.2, 2.5)
"""Lowest and highest frequency of a multisine over that of the short period. Below the band, bank and speed
leave the range of the model. The sines reach beyond the corner of the servo: below it, the servo's lag and
the damping act alike. An end at 1.5 gave two to five times wider intervals of M_q on three airframes.
"""
_MULTISINE_S = 20.0
"""Shortest multisine, s. Length of a multisine, s. Three multisines of 20 s on three controls gave 20
derivatives of both axes within 6 %.
"""
_PERIODS = 16.0
"""Least length of a multisine, in short periods. The band then holds seven harmonics for each control."""


@dataclass(frozen=True, slots=True)
class ScriptInput:
    """One input of a script's table."""

    name: str
    held: tuple[Control, ...]
    """Controls that the script holds during the input: those that move, and those whose motion would hide the
    response. Every other control stays with the autopilot."""
    length_s: float
    rest_s: float
    """Hands-off flight after the input, s: two periods of the motion."""
    unit_s: float = 0.0
    """Time unit of a stepped input, s; 0 for a multisine."""
    steps: Steps = ()
    sines: Mapping[Control, Multisine] | None = None

    @property
    def moved(self) -> tuple[Control, ...]:
        """Controls that the input moves."""
        return tuple(self.sines) if self.sines is not None else (STEPPED[self.name][0],)


def input_of(name: str, pace: Pace, controls: tuple[Control, ...] = CONTROLS) -> ScriptInput:
    """Return an input for an aircraft with these time constants and controls.

    Parameters
    ----------
    name
        One of ``NAMES``.
    """
    if name == MULTISINE:
        return _multisine(pace, controls)
    control, steps = STEPPED[name]
    unit = _unit_s(control, pace)
    period = pace.period_s if control == "elevator" else pace.dutch_roll_s
    sides = tuple(c for c in controls if (c == "elevator") == (control == "elevator"))
    length = unit * sum(units for units, _ in steps)
    return ScriptInput(name, sides, length, _rest_s(period), unit, steps)


def _multisine(pace: Pace, controls: tuple[Control, ...]) -> ScriptInput:
    """Return a multisine of all controls; the rudder has the lowest harmonics, for the slowest motion."""
    length = float(ceil(max(_MULTISINE_S, _PERIODS * pace.period_s)))
    low, high = (share * length / pace.period_s for share in _BAND)
    order = tuple(c for c in ("rudder", "aileron", "elevator") if c in controls)
    lines = disjoint_harmonics(max(2, round(low)), round(high), len(order))
    sines = {control: multisine(mine) for control, mine in zip(order, lines, strict=True)}
    rest = _rest_s(max(pace.period_s, pace.dutch_roll_s))
    return ScriptInput(MULTISINE, controls, length, rest, sines={c: sines[c] for c in controls})


def _unit_s(control: Control, pace: Pace) -> float:
    """Return the time unit, s: a quarter of a short period, two roll time constants, or half a Dutch roll."""
    wanted, least = {
        "elevator": (0.25 * pace.period_s, SHORTEST_UNIT_S),
        "aileron": (2.0 * pace.roll_s, _SHORTEST_AILERON_S),
        "rudder": (0.5 * pace.dutch_roll_s, SHORTEST_UNIT_S),
    }[control]
    return round(round(max(wanted, least) / _EVEN_S) * _EVEN_S, 2)


def _rest_s(period_s: float) -> float:
    return round(max(_SHORTEST_REST_S, 2.0 * period_s), 1)
