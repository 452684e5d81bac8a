"""Roll and yaw of the user's simulator: the flight without the difference between simulator and surrogate.

The simulator S flies the recorded aileron, rudder, elevator and throttle. The lateral model L is fitted to
the simulator's motion. The diagnosis compares L with y − (y_S − y_L), as on the pitch axis (``compare``). A
change of L by an effect therefore counts as an equal change of S.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from advisor.aircraft.aircraft import Aircraft, SideControl
from advisor.flight.maneuvers.maneuver import Maneuver
from advisor.gap.effects.actuator_lag import LAG
from advisor.gap.effects.transport_delay import DELAY
from advisor.model.axes.lateral import LATERAL
from advisor.oem.axis.parameter import FIRST_LAG_S, LARGEST_MOVE_S, LONGEST_LAG_S, Parameter
from advisor.oem.axis.prepare import prepare
from advisor.oem.axis.problem import COMMAND, AxisProblem, AxisRecord
from advisor.oem.axis.search import not_identifiable, solve
from advisor.oem.estimate import NoEstimate
from advisor.oem.extra import Prior
from advisor.oem.rows import Signal
from advisor.oem.solution import Solution
from advisor.oem.surface import Servo
from advisor.process.arrays import FloatArray
from advisor.simulators.air import refuse_unknown_air, standard_heights, winds
from advisor.simulators.as_given import without
from advisor.simulators.interface import control_fault, side_fault
from advisor.simulators.protocol import CONTROLS, Condition, Inputs, Progress, Replay, Simulator
from advisor.words.problems import UnusableInputError
from advisor.words.quantities import NORMAL_95

STEP_S = 0.02
"""Interval of the inputs and of the replay's stamps, s, as for the pitch axis."""
OWN_DELAY, OWN_LAG = Prior(0.0, 0.1), Prior(FIRST_LAG_S, 0.1)
"""Priors of delay and lag between the simulator's input and its surfaces, s. Replays without noise determine
both values without the priors."""
TURNS = {"aileron": ("L_delta_a", "L_p"), "rudder": ("N_delta_r", "N_beta")}
"""Two derivatives for each control: the control's moment, and the moment that opposes the motion.
``interface.control_fault`` compares the ratio of both with the simulator's response."""


def side_without_difference(
    maneuvers: Sequence[Maneuver],
    simulator: Simulator,
    aircraft: Aircraft,
    progress: Progress = lambda *_: None,
) -> tuple[list[Maneuver], Aircraft]:
    """Return the manoeuvres without the difference between simulator and surrogate, and the surrogate's file.

    Parameters
    ----------
    aircraft
        Aircraft file of the crew. The servos of the file are applied before the simulator; the file's model
        is not used.

    Raises
    ------
    UnusableInputError
        The records cannot be used, or the simulator does not fly roll and yaw.
    """
    said = simulator.description
    flown = prepare(LATERAL, maneuvers, aircraft)
    if isinstance(flown, NoEstimate):
        raise UnusableInputError(flown.code, flown.text, "Fly an aileron doublet and a rudder doublet.")
    _refuse_untaken(simulator, flown)
    heights, blown = standard_heights(maneuvers, aircraft), winds(maneuvers)
    refuse_unknown_air(said, heights)
    records = []
    for k, (maneuver, record) in enumerate(zip(maneuvers, flown.records, strict=True)):
        progress(f"{said} flies manoeuvre {maneuver.number}", k / len(maneuvers))
        level = replace(
            _condition(maneuver, record, aircraft),
            height_m=heights[maneuver.number] or 0.0,
            wind_m_s=blown.get(maneuver.number, (0.0, 0.0)),
        )
        inputs, t = _inputs(maneuver, record, aircraft)
        replay = simulator.replay(level, inputs)
        _refuse_broken(replay, said, maneuver, float(inputs.t[-1]))
        records.append(_as_record(replay, inputs, t))
    progress(f"fitting roll and yaw of {said}", 1.0)
    surrogate = _surrogate(tuple(records), flown, said)
    _refuse_wrong_control(surrogate, flown, said)
    left = surrogate.assembly.z - surrogate.fitted
    beyond = [
        {name: Signal(record.outputs[name].t, left[rows]) for name, rows in named.items()}
        for record, named in zip(records, surrogate.assembly.rows, strict=True)
    ]
    kept = [without(m, lost) for m, lost in zip(maneuvers, beyond, strict=True)]
    return kept, _file(surrogate, aircraft, said)


def _condition(maneuver: Maneuver, record: AxisRecord, aircraft: Aircraft) -> Condition:
    """Return the steady flight before the first step, at zero height and in still air."""

    def mean(signal: Signal) -> float:
        before = signal.y[signal.t < maneuver.span.start_s]
        return float(np.mean(before)) if len(before) else float(signal.y[0])

    path = mean(record.given["theta"]) - mean(record.given["alpha"])
    return Condition(mean(record.airspeed), 0.0, path, aircraft.reference.mass_kg)


def _inputs(maneuver: Maneuver, record: AxisRecord, aircraft: Aircraft) -> tuple[Inputs, FloatArray]:
    """Return the recorded inputs as deviations, after the file's servos, and their stamps in the record."""
    begin = min(signal.t[0] for signal in record.outputs.values())
    end = max(signal.t[-1] for signal in record.outputs.values())
    t: FloatArray = begin + STEP_S * (np.arange(int(np.ceil((end - begin) / STEP_S)) + 1) + 0.5)
    moved = {}
    for name in ("elevator", *CONTROLS):
        channel = maneuver.channels.get(name)
        if channel is None or len(channel) < 2:
            continue
        servo = _servo(getattr(aircraft, name)) if name in LATERAL.inputs else Servo()
        grid = np.union1d(servo.grid(channel.t)[0], t)
        y = np.interp(t, grid, servo.move(channel.t, channel.y, grid)[0])
        before = t < max(maneuver.span.start_s, t[0] + STEP_S)
        moved[name] = y - float(np.mean(y[before]))
    elevator = moved.pop("elevator", np.zeros(len(t)))
    return Inputs(t - begin, elevator, moved), t


def _servo(control: SideControl) -> Servo:
    return Servo(control.lag_s or 0.0, control.delay_s or 0.0)


def _as_record(replay: Replay, inputs: Inputs, t: FloatArray) -> AxisRecord:
    def read(series: FloatArray) -> Signal:
        return Signal(t, np.interp(inputs.t, replay.t, series))

    motion: Mapping[str, FloatArray | None] = {
        name: getattr(replay, name) for name in ("p", "r", "bank", "a_y", "beta")
    }
    return AxisRecord(
        inputs={name: Signal(t, inputs.others[name]) for name in LATERAL.inputs if name in inputs.others},
        outputs={name: read(series) for name, series in motion.items() if series is not None},
        given={
            "airspeed": read(replay.airspeed_m_s),
            "alpha": read(replay.alpha),
            "theta": read(replay.theta),
            "q": read(replay.q),
        },
    )


def _surrogate(records: tuple[AxisRecord, ...], flown: AxisProblem, said: str) -> Solution:
    """Return the lateral model fitted to the replays, with lag and delay between input and surface."""
    problem = AxisProblem(LATERAL, records, flown.reference_airspeed_m_s)
    moving = [name for name in LATERAL.inputs if problem.flies(name)]
    lags = (Parameter((n, "lag_s"), OWN_LAG, LARGEST_MOVE_S, (0.0, LONGEST_LAG_S)) for n in moving)
    own = [Parameter(COMMAND, OWN_DELAY, LARGEST_MOVE_S), *lags]
    solution = solve(problem, own)
    if isinstance(solution, NoEstimate):
        raise UnusableInputError(
            "simulator_lateral",
            f"No linear model describes the roll and yaw of {said}: {solution.text}",
            "Check its signs and units in roll and yaw, and that it flies at this speed.",
        )
    return solution


def _file(surrogate: Solution, aircraft: Aircraft, said: str) -> Aircraft:
    """Return the aircraft file with the surrogate as its model, and with both servos in series."""
    untold = not_identifiable(surrogate)
    estimated = zip(LATERAL.names.reported, surrogate.theta, strict=True)
    servos = {}
    for name in LATERAL.inputs:
        control = getattr(aircraft, name)
        delay_s = _beyond(surrogate, "command_delay_s", DELAY.smallest)
        # A command ahead of its stamps takes as much from a lag: the two act nearly alike.
        early_s = min(surrogate.problem.at(COMMAND), 0.0)
        lag_s = _beyond(surrogate, f"{name}_lag_s", LAG.smallest, early_s)
        servos[name] = replace(
            control,
            lag_s=(control.lag_s or 0.0) + lag_s if lag_s else control.lag_s,
            delay_s=(control.delay_s or 0.0) + delay_s if delay_s else control.delay_s,
        )
    return replace(
        aircraft,
        model={name: float(value) for name, value in estimated if name not in untold},
        reference_airspeed_m_s=surrogate.problem.reference_airspeed_m_s or aircraft.reference_airspeed_m_s,
        simulator=said,
        **servos,
    )


def _beyond(surrogate: Solution, name: str, least: float, other_s: float = 0.0) -> float:
    """Return the simulator's lag or delay combined with another time, s; 0 if insignificant."""
    value, std = surrogate.nuisances.get(name, (0.0, 0.0))
    value += other_s
    return value if value > max(least, NORMAL_95 * std) else 0.0


def _refuse_untaken(simulator: Simulator, flown: AxisProblem) -> None:
    """Refuse a simulator that does not support a control of the test."""
    for name in LATERAL.inputs:
        if flown.flies(name) and name not in simulator.takes:
            raise UnusableInputError(
                "simulator_control",
                f"{simulator.description} takes no {name}, which the flight has flown.",
                f"Name the {name} among its inputs (takes, controls or fmu.{name}).",
            )


def _refuse_broken(replay: Replay, said: str, maneuver: Maneuver, duration_s: float) -> None:
    """Refuse a replay without roll and yaw, with an early end, or with a wrong sign or unit."""
    missing = [name for name in LATERAL.needed if getattr(replay, name) is None]
    if replay.a_y is None and replay.beta is None:
        missing.append("a_y (or beta)")
    if missing:
        raise UnusableInputError(
            "simulator_lateral",
            f"{said} returns no {', '.join(missing)}, which roll and yaw need.",
            "Add these quantities to its replay or observation (for an FMU, to fmu: in the aircraft file).",
        )
    if replay.t[-1] < duration_s - 0.1:
        raise UnusableInputError(
            "simulator_replay",
            f"{said} ends manoeuvre {maneuver.number} at {replay.t[-1]:.2g} s of {duration_s:.2g} s.",
            "Check that the model flies at the speed and height of the flight.",
        )
    fault = side_fault(replay)
    if fault is not None:
        raise fault.refuse(said)
    if np.max(np.abs(np.asarray(replay.bank))) > np.pi / 2.0:
        raise UnusableInputError(
            "simulator_departs",
            f"{said} rolls onto its back in manoeuvre {maneuver.number}.",
            "Check the calibration of aileron and rudder, and that the model is stable at this speed.",
        )


def _refuse_wrong_control(surrogate: Solution, flown: AxisProblem, said: str) -> None:
    """Refuse a simulator whose aileron or rudder has a wrong sign or unit."""
    derivatives = dict(zip(LATERAL.names.reported, map(float, surrogate.theta), strict=True))
    for name, (turns, against) in TURNS.items():
        if flown.flies(name):
            fault = control_fault(name, derivatives[turns], abs(derivatives[turns] / derivatives[against]))
            if fault is not None:
                raise fault.refuse(said)
