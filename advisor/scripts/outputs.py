"""Servo outputs of each control for a script that moves them: forward mixer and calibrations.

The rows of ``mixers.py`` read a control from the outputs' pulses. The forward mixer is the inverse. One
degree of a control moves each output by its factor and leaves every other control unchanged.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.aircraft.controls import Pairs
from advisor.flight.vehicle.mixers import Control as AnyControl
from advisor.flight.vehicle.mixers import Role, arduplane_roles
from advisor.scripts.inputs import CONTROLS, Control

_ALL: tuple[AnyControl, ...] = (*CONTROLS, "flap")
_FUNCTIONS = ((4,), (19,), (21,), (24, 25), (77, 78), (79, 80))
"""Values of SERVOn_FUNCTION that a script moves, in groups that a mixer drives together."""


@dataclass(frozen=True, slots=True)
class StatedOutput:
    """A servo output that the aircraft file names for a control."""

    output: int
    factor: float
    """Degrees of the output for one degree of the control."""
    calibration: Pairs | None


def forward(roles: Mapping[int, Role]) -> dict[int, dict[Control, float]]:
    """Return degrees of each output for one degree of each control, for outputs of one mixer.

    The factors are the pseudo-inverse of the reading weights, so that reading them back gives the control
    alone.
    """
    outputs = sorted(roles)
    weights = np.array([[roles[n].weight(control) for n in outputs] for control in _ALL])
    factors = np.linalg.pinv(weights)
    return {
        n: {
            control: round(float(factors[row, column]), 6)
            for column, control in enumerate(CONTROLS)
            if abs(factors[row, column]) > 1e-9
        }
        for row, n in enumerate(outputs)
    }


def factors_by_function() -> dict[int, dict[Control, float]]:
    """Return degrees of an output for one degree of each control, by the output's SERVOn_FUNCTION."""
    factors: dict[int, dict[Control, float]] = {}
    for functions in _FUNCTIONS:
        roles = arduplane_roles(dict(enumerate(functions, 1)), None)
        factors |= {functions[n - 1]: moves for n, moves in forward(roles).items()}
    return factors


def stated_outputs(aircraft: Aircraft, control: Control) -> tuple[StatedOutput, ...]:
    """Return the outputs that the aircraft file names for a control; empty where the autopilot's parameters
    name them.
    """
    surface = getattr(aircraft, control)
    if control == "elevator" and aircraft.elevator.outputs:
        listed = aircraft.elevator.outputs
        return tuple(StatedOutput(o.output, float(np.sign(o.weight)), o.calibration) for o in listed)
    if surface.output == "auto":
        return ()
    return (StatedOutput(surface.output, 1.0, surface.calibration),)
