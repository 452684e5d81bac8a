"""Roll and yaw of a simulator, checked before its physics: aileron and rudder turn it as an aircraft.

A doublet of each control that the simulator takes is flown. The kinematics of the replay give signs and
units, and a regression of the angular accelerations gives the derivatives of the control.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from advisor.flight.signals.messages import FloatArray
from advisor.simulators.interface import InterfaceFault, control_fault, side_fault
from advisor.simulators.protocol import Condition, Inputs, Replay, Simulator
from advisor.simulators.side import TURNS

_STEP_S, _BEGINS_S, _UNIT_S, _LASTS_S = 0.005, 1.0, 0.5, 5.0
"""Step, start and unit of the doublet, and length of the record, s."""
_SIZE_RAD = float(np.radians(1.0))
_MOTION = ("beta", "p", "r")
_NEEDED = ("p", "r", "bank", "beta")


@dataclass(frozen=True)
class CheckedSide:
    """Findings on roll and yaw."""

    derivatives: Mapping[str, float] = field(default_factory=dict)
    """L and N by β, p, r and the controls that were flown."""
    fault: InterfaceFault | None = None
    notes: tuple[str, ...] = ()


def check_side(simulator: Simulator, condition: Condition) -> CheckedSide:
    """Fly a doublet of each control of roll and yaw, and test the answer.

    Raises
    ------
    UnusableInputError
        The simulator does not fly.
    """
    found: dict[str, float] = {}
    notes: list[str] = []
    for control in (name for name in TURNS if name in simulator.takes):
        t: FloatArray = _STEP_S * (np.arange(round(_LASTS_S / _STEP_S), dtype=np.float64) + 0.5)
        moved = _doublet(t)
        replay = simulator.replay(condition, Inputs(t, np.zeros(t.size), {control: moved}))
        missing = [name for name in _NEEDED if getattr(replay, name) is None]
        if missing:
            notes.append(f"It returns no {', '.join(missing)}: the {control} is not checked.")
            continue
        own, answer = _derivatives(replay, np.interp(replay.t, t, moved), control)
        fault = side_fault(replay) or control_fault(control, own[TURNS[control][0]], answer)
        if fault is not None:
            return CheckedSide(found, fault, tuple(notes))
        found |= own
    return CheckedSide(found, None, tuple(notes))


def _doublet(t: FloatArray) -> FloatArray:
    """Return a doublet, rad, shape (n,)."""
    since = (t - _BEGINS_S) / _UNIT_S
    return _SIZE_RAD * (((since >= 0.0) & (since < 1.0)) * 1.0 - ((since >= 1.0) & (since < 2.0)) * 1.0)


def _derivatives(replay: Replay, moved: FloatArray, control: str) -> tuple[dict[str, float], float]:
    """Return L and N by the motion and the control, and the size of the answer (``control_fault``)."""
    motion = [np.asarray(getattr(replay, name)) for name in _MOTION]
    columns = np.column_stack([*motion, moved, np.ones(len(moved))])
    factor = TURNS[control][0].removeprefix("L_").removeprefix("N_")
    found: dict[str, float] = {}
    for letter, rate in (("L", motion[1]), ("N", motion[2])):
        slopes = np.linalg.lstsq(columns, np.gradient(rate, replay.t))[0]
        found |= {f"{letter}_{name}": float(x) for name, x in zip((*_MOTION, factor), slopes, strict=False)}
    turns, against = TURNS[control]
    return found, abs(found[turns] / found[against]) if found[against] else np.inf
