"""Estimation problem of the short period: data of one or more manoeuvres, each channel at its own stamps."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from advisor.aircraft.added_term import OF_PITCH
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.outputs import LOCAL, OUTPUTS, SHARED
from advisor.model.response import Grid, Index
from advisor.oem.rows import (
    Laid,
    Piece,
    Signal,
    events_of,
    finite,
    lay_rows,
    measured_in,
    padded,
    with_samples,
)
from advisor.oem.surface import Servo
from advisor.oem.terms import forcing
from advisor.process.arrays import FloatArray

ASSUMED_M_S = 20.0
"""Assumed air speed if none is known, m/s. The gust angle and the weight's part of α̇ depend on the air
speed."""
STAMP_DIGITS = 12
"""Decimals to which step lengths are distinguished, because equal steps share their matrices."""


@dataclass(frozen=True, slots=True)
class Record:
    """Data of one manoeuvre, in SI units."""

    elevator: Signal
    """Elevator command in rad, linear between its stamps, before the problem's servo."""
    outputs: Mapping[str, Signal]
    """Measured outputs by the names of ``OUTPUTS``: q, and alpha or a_z. NaN samples are ignored."""
    airspeed: Signal | None = None
    """Air speed V in m/s; None for a constant speed, as in Eqs. (1)-(2)."""
    normal_gravity: Signal | None = None
    """Gravity normal to the flight path in the plane of symmetry, over g; None for 1, as in level flight."""
    gravity_z: Signal | None = None
    """Component g·cos θ·cos φ of gravity, m/s², in the equation of a_z; None for 9.80665."""
    sideslip_turn: Signal | None = None
    """Part of α̇ that rolling in sideslip causes without a force, -tan β·(p·cos α + r·sin α), rad/s; None for
    an unknown sideslip."""
    held: bool = False
    """Whether the input is held between its stamps instead of linear."""
    before: Signal | None = None
    """Elevator command before the record, which still moves the servo at its begin."""
    signals: Mapping[str, Signal] = field(default_factory=dict)
    """Further signals that added terms need, by their names in expressions."""
    inferred_alpha: Signal | None = None
    """Angle of attack from the motion, rad, if α is not measured. The search starts from the inferred α, but
    no residual uses it."""

    @property
    def command(self) -> Signal:
        """Elevator command in rad, with its samples before the record."""
        return self.elevator.after(self.before)

    @property
    def alpha(self) -> Signal:
        """Angle of attack, measured or inferred from the motion.

        Raises
        ------
        ValueError
            The record has neither a measured nor an inferred angle of attack.
        """
        signal = self.outputs.get("alpha", self.inferred_alpha)
        if signal is None:
            raise ValueError("a record needs an angle of attack, measured or inferred from the motion")
        return signal


@dataclass(frozen=True, slots=True)
class OutputErrorProblem:
    """Records that share the six derivatives, and the properties of their instruments."""

    records: tuple[Record, ...]
    reference_airspeed_m_s: float | None = None
    """Air speed of the derivatives, m/s; None if the derivatives do not scale with speed."""
    servo: Servo = field(default_factory=Servo)
    vane_arm_m: float = 0.0
    accelerometer_arm_m: float = 0.0
    alpha_delay_s: float = 0.0
    """Delay of the angle of attack's measurement, s."""
    alpha_is_computed: bool = False
    """Whether the angle of attack comes from inertial sensors, which have no arm, and not from a vane."""
    steady_moment_rad: float = 0.0
    """Moment that does not scale with V², as the balancing deflection at the reference speed, rad."""
    per_coefficient: Mapping[str, float] = field(default_factory=dict)
    """Moment derivative for a coefficient of 1, by the derivative's name; empty for an unknown geometry."""
    airspeed_may_be_off: bool = True
    """Whether a scale error of the air speed in a_z is estimated. Equivalent, ratiometric or derived speeds
    are off by some per cent, which would bias Z_alpha and M_alpha."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Parameters held at a value, by name."""
    terms: Mapping[str, float] = field(default_factory=dict)
    """Coefficient of each term that the user added, by its text."""
    means: Mapping[str, float] = field(default_factory=dict)
    """Value from which a signal counts in the terms, by the signal's name."""

    def holding(self, shared: FloatArray, local: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Return shared (7,) and local (m, 7) parameters with the fixed ones at their values."""
        shared, local = shared.copy(), local.copy()
        for name, value in self.fixed.items():
            if name in SHARED:
                shared[SHARED.index(name)] = value
            else:
                local[:, LOCAL.index(name)] = value
        return shared, local


@dataclass(frozen=True, slots=True, kw_only=True)
class Assembly(Laid):
    """Short-period problem laid out for the kernel."""

    grid: Grid
    events: FloatArray
    """Shape (E,): stamps of the events, s."""


def assemble(problem: OutputErrorProblem) -> Assembly:
    """Lay the records out at the union of their stamps.

    Raises
    ------
    ValueError
        A record lacks q, the input, or both alpha and a_z, or has fewer than two samples of one of these.
    """
    pieces = [_piece(record, problem) for record in problem.records]
    measured = {name for piece in pieces for name in piece.outputs}
    laid = lay_rows(pieces, OUTPUTS)
    columns = dict(laid.columns)
    kinds, kind = _kinds(columns.pop("steps"))
    grid = Grid(
        first=laid.first,
        kind=kind,
        step_s=np.ascontiguousarray(kinds[:, 0]),
        ratio=np.ascontiguousarray(kinds[:, 1]),
        row=laid.row,
        arm=problem.accelerometer_arm_m,
        **columns,
    )
    return Assembly(
        grid=grid,
        events=np.concatenate([piece.t for piece in pieces]),
        **laid.measurements,
        free=_free(measured, problem.airspeed_may_be_off and {"alpha", "a_z"} <= measured, problem.fixed),
    )


def _kinds(steps: FloatArray) -> tuple[FloatArray, Index]:
    """Return the distinct steps (U, 2), and the index of each step (E, 2) among them. Equal steps share
    matrices.

    If the speed changes, hardly two steps are equal, and no equal steps are sought.
    """
    if np.any(steps[:, 1] != 1.0):
        return steps, np.arange(len(steps), dtype=np.int64)
    lengths, kind = np.unique(steps[:, 0], return_inverse=True)
    return np.column_stack([lengths, np.ones(len(lengths))]), kind.astype(np.int64)


def _free(measured: set[str], scaled: bool, fixed: Mapping[str, float]) -> Index:
    """Return the indices of the 14 parameters that the measured outputs determine.

    Without alpha no output determines the level of the angle of attack, which Z_0 and M_0 absorb. The initial
    angle of attack then stays at the start of the search.
    """
    local = ["Z_0", "M_0", *(["alpha_initial"] if "alpha" in measured else []), "q_initial"]
    if "theta" in measured:
        local += ["theta_initial", "q_bias"]
    if "a_z" in measured:
        local += ["a_z_bias"]
    shared = [name for name in SHARED if name != "airspeed_scale" or scaled]
    free = [name for name in (*shared, *local) if name not in fixed]
    return np.array([(*SHARED, *LOCAL).index(name) for name in free])


def _piece(record: Record, problem: OutputErrorProblem) -> Piece:
    """Return one record at the union of its stamps."""
    outputs = measured_in(record.outputs, OUTPUTS, {"alpha": problem.alpha_delay_s})
    with_samples(
        {**outputs, "the elevator": record.elevator},
        ("q", "alpha" if "alpha" in outputs else "a_z", "the elevator"),
    )
    t = events_of(outputs, [problem.servo.grid(record.elevator.t)])
    step = np.diff(t)
    middle = t[:-1] + step / 2.0
    at_event, start, arrival = problem.servo.move(*record.command, t, record.held)
    added = _added(record, problem, middle, (start[:-1] + arrival) / 2.0) if problem.terms else None
    ratio, airspeed, acceleration = np.ones(len(step)), np.ones(len(t)), np.zeros(len(t))
    forcing = np.zeros(len(step))
    if record.airspeed is not None:
        airspeed = record.airspeed.at(t)
        acceleration = _slope(airspeed, t)
        speed = record.airspeed.at(middle)
        pull = GRAVITY_M_S2 / speed
        if problem.reference_airspeed_m_s is not None:
            ratio = speed / problem.reference_airspeed_m_s
            forcing = pull - ratio * GRAVITY_M_S2 / problem.reference_airspeed_m_s
            steady = problem.steady_moment_rad * steady_share(problem, airspeed)
            at_event, start, arrival = at_event + steady, start + steady, arrival + steady[1:]
        if record.normal_gravity is not None:
            forcing += pull * (record.normal_gravity.at(middle) - 1.0)
    gravity = np.full(len(t), GRAVITY_M_S2) if record.gravity_z is None else record.gravity_z.at(t)
    if record.sideslip_turn is not None:
        forcing += record.sideslip_turn.at(middle)
        gravity = gravity + airspeed * record.sideslip_turn.at(t)  # the turn is no specific force
    columns = {
        "steps": padded(np.column_stack([np.round(step, STAMP_DIGITS), ratio])),
        "elevator": at_event,
        "start": start,
        "slope": padded((arrival - start[:-1]) / step),
        "known": padded(forcing) if added is None else padded(forcing) + added[:, 0],
        "turned": np.zeros(len(t)) if added is None else added[:, 1],
        "vane": -problem.vane_arm_m / airspeed if problem.vane_arm_m else np.zeros(len(t)),
        "airspeed": airspeed,
        "acceleration": acceleration,
        "gravity": gravity,
    }
    return Piece(t, outputs, columns)


def _added(
    record: Record, problem: OutputErrorProblem, middle: FloatArray, surface: FloatArray
) -> FloatArray:
    """Return what the added terms contribute to α̇ and q̇, shape (E, 2), from the steps' middles."""
    alpha = Signal(record.alpha.t - problem.alpha_delay_s, record.alpha.y)
    measured = {"alpha": alpha, "q": record.outputs["q"], "V": record.airspeed, **record.signals}
    values = {name: finite(signal).at(middle) for name, signal in measured.items() if signal is not None}
    return forcing(problem.terms, OF_PITCH, problem.means, {**values, "delta_e": surface})


def _slope(y: FloatArray, t: FloatArray) -> FloatArray:
    """Return the slope at each stamp of a parabola through the sample and its neighbours, shape (n,)."""
    step = np.diff(t)
    rate = np.diff(y) / step
    inside = (step[1:] * rate[:-1] + step[:-1] * rate[1:]) / (step[:-1] + step[1:])
    return np.concatenate([rate[:1], inside, rate[-1:]])


def steady_share(problem: OutputErrorProblem, airspeed: FloatArray) -> FloatArray:
    """Return the deflections equivalent to a steady moment, shape (n,), over the one at the reference
    speed."""
    reference = problem.reference_airspeed_m_s
    return np.zeros(len(airspeed)) if reference is None else (reference / airspeed) ** 2 - 1.0
