"""Check of a simulator's interface: trim, rest, response to every control, and SI units."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import nan

import numpy as np

from advisor.aircraft.aircraft import Aircraft
from advisor.gap.result import spelled
from advisor.gap.simulator.layout import DERIVATIVES, natural_frequency
from advisor.process.arrays import FloatArray
from advisor.simulators.axes.side_difference import TURNS
from advisor.simulators.identified import identified_pitch, identified_side
from advisor.simulators.interface import InterfaceFault, control_fault, interface_fault, side_fault
from advisor.simulators.protocol import CONDITIONS, CONTROLS, Condition, Inputs, Replay, Simulator
from advisor.words.problems import UnusableInputError

_STEP_S, _LEAD_S = 0.005, 1.0
"""Time step of the check's record, s, and time before the input, s."""
_UNIT_S, _LASTS_S = 0.4, 9.0
"""Time unit of the 3-2-1-1, s, and length of its record, s."""
_SIDE_UNIT_S, _SIDE_LASTS_S = 0.5, 5.0
"""Time unit of the aileron and rudder doublet, s, and length of its record, s."""
_SIZE_RAD = float(np.radians(1.0))
"""Size of a control's step, rad, by which signs and units are checked."""
_SMALL = 0.2
"""Size of a step for the derivatives, relative to ``_SIZE_RAD``. The path turns little, so that gravity's
terms of third order stay below 0.03 % of a derivative."""
_PROPORTIONAL = 0.2
"""Largest relative deviation from a proportional response, beyond which a simulator has play or a dead band.
Its derivatives are then those of the full step."""
_NEEDED = ("p", "r", "bank", "beta")
_REST_S = 5.0
"""Length of the flight with resting controls, s."""
_MOVES_RAD_S = 1e-6
"""Least change of the pitch rate, rad/s, of a simulator that responds to its elevator, above rounding
errors."""
_RESTS_RAD_S = 1e-3
"""Largest pitch rate of a trimmed simulator at rest, rad/s: 0.06 deg/s, half of a gyro's bias."""


@dataclass(frozen=True)
class CheckedSimulator:
    """Results of a simulator's check at one flight condition."""

    simulator: str
    airspeed_m_s: float
    height_m: float
    alpha_rad: float
    """Angle of attack in the trimmed flight, rad."""
    trim: Mapping[str, float]
    """Trimmed controls that the simulator reports, by name."""
    a_z_m_s2: float
    """Specific force along body z in the trimmed flight, m/s²."""
    rest_q_rad_s: float
    """Largest pitch rate with resting controls, rad/s."""
    takes: tuple[str, ...]
    lacks: tuple[str, ...]
    """Controls, parts of the condition, and ``increments`` that the simulator does not support."""
    derivatives: Mapping[str, float] = field(default_factory=dict)
    std: Mapping[str, float] = field(default_factory=dict)
    """Standard deviation of each derivative of pitch, roll and yaw, by the motion that is not linear."""
    lag_s: float = nan
    """First-order lag between the command and the motion, s."""
    dead_time_s: float = nan
    omega_rad_s: float = nan
    """Undamped natural frequency of the short period, rad/s; 0 for negative stiffness."""
    damping: float = nan
    side: Mapping[str, float] = field(default_factory=dict)
    """Derivatives of roll and yaw for the controls that the simulator supports."""
    fault: InterfaceFault | None = None
    notes: tuple[str, ...] = ()


def check(simulator: Simulator, condition: Condition, aircraft: Aircraft) -> CheckedSimulator:
    """Fly a simulator at rest and through a 3-2-1-1, and identify its short period.

    Effects of the aircraft file are not included, and a note names them.

    Raises
    ------
    UnusableInputError
        The simulator does not trim, does not fly, or does not respond to the elevator.
    """
    t = _stamps(_LASTS_S)
    rest = t[t < _REST_S]
    still = simulator.replay(condition, Inputs(rest, np.zeros(rest.size)))
    flown = simulator.replay(condition, Inputs(t, _three_two_one_one(t)))
    offered = {*CONTROLS, *CONDITIONS}
    takes = {*simulator.takes} | ({"increments"} if simulator.takes_increments else set())
    checked = CheckedSimulator(
        simulator.description, condition.airspeed_m_s, condition.height_m, float(still.alpha[0]), still.trim,
        float(still.a_z[0]), float(np.max(np.abs(still.q))), tuple(sorted(takes)),
        tuple(sorted({*offered, "increments"} - takes)),
        notes=(*getattr(simulator, "notes", ()), *_not_flown(aircraft)),
    )  # fmt: skip
    _refuse_unmoved(flown, simulator.description)
    fault = interface_fault(flown) or control_fault("elevator", -1.0, _answer(flown))
    if fault is not None:
        return replace(checked, fault=fault)
    checked = _identified(checked, simulator, condition, flown, t)
    fault = control_fault("elevator", checked.derivatives["M_delta_e"], _answer(flown))
    if fault is not None:
        return replace(checked, fault=fault)
    return _check_side(checked, simulator, condition)


def _not_flown(aircraft: Aircraft) -> Iterator[str]:
    """Yield a sentence about parts of the aircraft file that only ``advisor gap`` adds to its simulator."""
    servo = aircraft.elevator
    added = [f"servo {name}" for name, size in (("lag", servo.lag_s), ("delay", servo.delay_s)) if size]
    if added := [*added, *map(spelled, aircraft.effects)]:
        yield (
            "The check flies the simulator alone. It leaves out the parts that advisor gap adds from the "
            f"aircraft file: {', '.join(added)}."
        )


def _stamps(lasts_s: float) -> FloatArray:
    """Return the middle times of a record's steps, s."""
    return _STEP_S * (np.arange(round(lasts_s / _STEP_S), dtype=np.float64) + 0.5)


def _check_side(checked: CheckedSimulator, simulator: Simulator, condition: Condition) -> CheckedSimulator:
    """Fly a doublet of each supported control of roll and yaw, and test the response."""
    side: dict[str, float] = {}
    notes = [*checked.notes]
    for control in (name for name in TURNS if name in simulator.takes):
        t = _stamps(_SIDE_LASTS_S)
        moved = _steps(t, _SIDE_UNIT_S, (1.0, 1.0))
        replay = simulator.replay(condition, Inputs(t, np.zeros(t.size), {control: moved}))
        missing = [name for name in _NEEDED if getattr(replay, name) is None]
        if missing:
            notes.append(f"It returns no {', '.join(missing)}: the {control} is not checked.")
            continue
        own, std, answer = _side_derivatives(simulator, condition, t, moved, control)
        fault = side_fault(replay) or control_fault(control, own[TURNS[control][0]], answer)
        if fault is not None:
            return replace(checked, side=side, fault=fault, notes=tuple(notes))
        side |= own
        checked = replace(checked, std={**checked.std, **std})
    return replace(checked, side=side, notes=tuple(notes))


def _side_derivatives(
    simulator: Simulator, condition: Condition, t: FloatArray, moved: FloatArray, control: str
) -> tuple[dict[str, float], dict[str, float], float]:
    """Return L and N by motion and control, their errors, and the response's size (``control_fault``)."""
    still = np.zeros(t.size)
    ways = [
        simulator.replay(condition, Inputs(t, still, {control: sign * _SMALL * moved}))
        for sign in (1.0, -1.0)
    ]
    values = identified_side(ways[0], ways[1], t, _SMALL * moved)
    turns, against = TURNS[control]
    named = {name.replace("_u", f"_{turns[2:]}"): value for name, value in values.items()}
    derivatives = {name: value.value for name, value in named.items()}
    answer = abs(derivatives[turns] / derivatives[against]) if derivatives[against] else np.inf
    return derivatives, {name: value.std for name, value in named.items()}, answer


def _refuse_unmoved(flown: Replay, said: str) -> None:
    """Refuse a simulator that does not move during a 3-2-1-1."""
    if float(np.ptp(flown.q)) < _MOVES_RAD_S:
        raise UnusableInputError(
            "simulator_elevator",
            f"{said} does not move: through a 3-2-1-1 of ±1 deg its pitch rate changes by "
            f"{np.degrees(np.ptp(flown.q)):.2g} deg/s.",
            "Check that step() advances the motion, and which input the elevator is.",
        )


def _answer(flown: Replay) -> float:
    """Return the ratio of the changes of angle of attack and elevator."""
    return float(np.ptp(flown.alpha)) / (2.0 * _SIZE_RAD)


def _identified(
    checked: CheckedSimulator, simulator: Simulator, condition: Condition, flown: Replay, t: FloatArray
) -> CheckedSimulator:
    """Return the results with derivatives, lag, dead time and natural motion added."""
    elevator = _three_two_one_one(t)
    size = _SMALL
    up = simulator.replay(condition, Inputs(t, size * elevator))
    if abs(float(np.ptp(up.q)) / (size * float(np.ptp(flown.q))) - 1.0) > _PROPORTIONAL:
        up, size = flown, 1.0
    down = simulator.replay(condition, Inputs(t, -size * elevator))
    pitch = identified_pitch(up, down, t, size * elevator)
    values = {name: value.value for name, value in pitch.derivatives.items()}
    numbers = np.array([values[name] for name in DERIVATIVES])
    omega = natural_frequency(numbers)
    damping = -(numbers[0] + numbers[4]) / (2.0 * omega) if omega > 0.0 else nan
    notes = [*checked.notes]
    if size == 1.0:
        notes.append(
            "Its response is not proportional to the elevator, so the derivatives hold for a step of 1 deg."
        )
    if checked.rest_q_rad_s > _RESTS_RAD_S:
        notes.append(
            f"With resting controls it turns by {np.degrees(checked.rest_q_rad_s):.2f} deg/s: its trim is "
            "not steady, and every replay starts with that motion."
        )
    return replace(
        checked, derivatives=values, std={name: value.std for name, value in pitch.derivatives.items()},
        lag_s=pitch.lag_s.value, dead_time_s=pitch.dead_time_s.value,
        omega_rad_s=omega, damping=float(damping), notes=tuple(notes),
    )  # fmt: skip


def _three_two_one_one(t: FloatArray) -> FloatArray:
    """Return a 3-2-1-1 of the elevator, rad, shape (n,)."""
    return _steps(t, _UNIT_S, (3.0, 2.0, 1.0, 1.0))


def _steps(t: FloatArray, unit_s: float, units: Sequence[float]) -> FloatArray:
    """Return alternating steps, each with the duration of its number of units, rad, shape (n,)."""
    onsets = _LEAD_S + unit_s * np.concatenate([[0.0], np.cumsum(units)])
    out = np.zeros(t.size)
    for k, (begin, end) in enumerate(pairwise(onsets)):
        out[(t >= begin) & (t < end)] = _SIZE_RAD if k % 2 == 0 else -_SIZE_RAD
    return out
