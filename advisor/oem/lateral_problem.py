"""The estimation problem of the lateral axis: data of one or more manoeuvres, each channel at its stamps."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.flight.signals.messages import FloatArray
from advisor.model.axis_response import AxisGrid
from advisor.model.lateral import LATERAL
from advisor.model.response import Index
from advisor.oem.problem import finite, merged
from advisor.oem.rows import Laid, Signal, lay_rows
from advisor.oem.surface import Servo, padded

_BETA, _P, _R, _BANK = range(len(LATERAL.states))
LEAST_PART = 0.2
"""Least range of an input over that of the larger one, for a test of this input. A rudder of 0.9 deg
in an aileron test of 12 deg follows the motion. Its derivatives would be wrong by half."""
NEEDED = ("p", "r", "bank")
"""Outputs that every record has."""
CAUSES = ("command", *LATERAL.inputs)
"""Causes that change the inputs of a grid: the delay of all commands, and the lag of each servo."""


@dataclass(frozen=True, slots=True)
class LateralRecord:
    """Data of one lateral manoeuvre, in SI units."""

    inputs: Mapping[str, Signal]
    """Commands of aileron and rudder, rad; an input that was not recorded did not move."""
    outputs: Mapping[str, Signal]
    """Measured outputs by their names; p, r and bank always."""
    airspeed: Signal
    """True air speed, m/s."""
    alpha: Signal
    """Angle of attack, rad."""
    theta: Signal
    """Pitch angle, rad."""
    q: Signal
    """Pitch rate, rad/s."""


@dataclass(frozen=True, slots=True)
class LateralProblem:
    """Records that share the lateral derivatives, with the properties of their instruments."""

    records: tuple[LateralRecord, ...]
    reference_airspeed_m_s: float | None = None
    """Reference speed of the derivatives, m/s; None means that they do not scale with speed."""
    servos: Mapping[str, Servo] = field(default_factory=dict)
    """Servo of each input; an absent one has neither lag nor delay."""
    command_delay_s: float = 0.0
    """Delay of all commands behind their stamps, in addition to the servos', s."""
    delays_s: Mapping[str, float] = field(default_factory=dict)
    """Delay of an output relative to the rates, s; an absent one is 0."""
    beta_arm_m: float = 0.0
    """Distance of the sideslip vane ahead of the centre of gravity, m."""
    accelerometer_arm_m: float = 0.0
    """Distance of the accelerometer ahead of the centre of gravity, m."""

    @property
    def tells_force(self) -> bool:
        """Whether a record has the lateral acceleration or the sideslip."""
        return any({"a_y", "beta"} & record.outputs.keys() for record in self.records)

    def servo(self, name: str) -> Servo:
        """Return the servo of an input, late by the delay of all commands."""
        stated = self.servos.get(name, Servo())
        return Servo(stated.lag_s, stated.delay_s + self.command_delay_s)

    def moves(self, name: str) -> bool:
        """Return whether an input moves in any record."""
        return self.motion(name) > 0.0

    def motion(self, name: str) -> float:
        """Return the largest range of an input over the records, rad."""
        return max((float(np.ptp(r.inputs[name].y)) for r in self.records if name in r.inputs), default=0.0)

    def flies(self, name: str) -> bool:
        """Return whether an input is a part of the test, and not hands that hold the wings level."""
        return self.motion(name) > LEAST_PART * max(self.motion(other) for other in LATERAL.inputs)


@dataclass(frozen=True, slots=True, kw_only=True)
class LateralAssembly(Laid):
    """A problem of the lateral axis laid out for the kernel."""

    grid: AxisGrid
    begin: FloatArray
    """(m,) time of the first event of each record, s, to which the initial states belong."""


def assemble_lateral(problem: LateralProblem) -> LateralAssembly:
    """Lay the records on the union of their stamps.

    Raises
    ------
    ValueError
        A record lacks p, r or bank, or has fewer than two stamps of one of them.
    """
    pieces = [_Piece.of(record, problem) for record in problem.records]
    measured = {name for piece in pieces for name in piece.outputs}
    laid = lay_rows(pieces, LATERAL.outputs)

    def joined(name: str) -> FloatArray:
        return np.concatenate([getattr(piece, name) for piece in pieces])

    grid = AxisGrid(
        first=laid.first,
        **{name: joined(name) for name in _STACKED},
        row=laid.row,
        place=LATERAL.place,
        bias=LATERAL.bias,
        bank=_BANK,
        yaw=_R,
    )
    return LateralAssembly(
        names=LATERAL.names,
        grid=grid,
        begin=np.array([piece.t[0] for piece in pieces]),
        **laid.measurements,
        free=_free(problem, measured),
    )


def _free(problem: LateralProblem, measured: set[str]) -> Index:
    """Return which parameters the moved inputs and the measured outputs determine.

    Without a vane no output determines the level of the sideslip, and the constants of trim absorb any.
    """
    still = [name for name in LATERAL.inputs if not problem.moves(name)]
    shared = [k for k, term in enumerate(LATERAL.shared) if term.factor not in still]
    if not problem.tells_force:
        shared = [k for k in shared if LATERAL.shared[k].name in _WITHOUT_FORCE]
    fixed = {f"{name}_bias" for name in LATERAL.biases if name not in measured}
    if "beta" not in measured:
        fixed.add("beta_initial")
    names = LATERAL.names
    local = [len(names.shared) + j for j, name in enumerate(names.local) if name not in fixed]
    return np.array([*shared, *local], np.int64)


_WITHOUT_FORCE = ("Y_beta", *(term.name for term in LATERAL.shared if term.state != "beta"))
"""Derivatives that are estimated where neither the side force nor the sideslip is measured."""
_STACKED = (
    "step_s", "ratio", "inputs", "start", "slope", "changed", "changed_start", "changed_slope", "linear",
    "sine", "turn", "seen", "felt",
)  # fmt: skip
"""Fields of a grid that the pieces hold one after another."""


@dataclass(frozen=True, slots=True)
class _Piece:
    """One record on the union of its stamps; the fields of the grid have its shapes."""

    t: FloatArray
    outputs: Mapping[str, Signal]
    step_s: FloatArray
    ratio: FloatArray
    inputs: FloatArray
    start: FloatArray
    slope: FloatArray
    changed: FloatArray
    changed_start: FloatArray
    changed_slope: FloatArray
    linear: FloatArray
    sine: FloatArray
    turn: FloatArray
    seen: FloatArray
    felt: FloatArray

    @classmethod
    def of(cls, record: LateralRecord, problem: LateralProblem) -> "_Piece":
        outputs = {
            name: _earlier(finite(record.outputs[name]), problem.delays_s.get(name, 0.0))
            for name in LATERAL.outputs
            if name in record.outputs
        }
        for name in NEEDED:
            if name not in outputs or len(outputs[name].t) < 2:
                raise ValueError(f"a record needs at least two samples of {name}")
        stamps = [signal.t for signal in outputs.values()]
        begin, end = min(t[0] for t in stamps), max(t[-1] for t in stamps)
        corners, pace = list(stamps), np.inf
        for name, command in record.inputs.items():
            breaks, own_pace = problem.servo(name).grid(command.t)
            corners.append(breaks[(breaks > begin) & (breaks < end)])
            pace = min(pace, own_pace)
        t = merged(np.concatenate(corners), pace)
        step = np.diff(t)
        moved = (*_moved(record, problem, t), *_changed(record, problem, t))
        middle = t[:-1] + step / 2.0
        speed = padded(record.airspeed.at(middle))
        ratio = np.ones(len(t))
        if problem.reference_airspeed_m_s is not None:
            ratio = speed / problem.reference_airspeed_m_s
        linear, sine, turn = _known(record, middle, speed)
        seen, felt = _outputs(record.airspeed.at(t), problem)
        return cls(t, outputs, padded(step), ratio, *moved, linear, sine, turn, seen, felt)


def _earlier(signal: Signal, delay_s: float) -> Signal:
    return Signal(signal.t - delay_s, signal.y) if delay_s else signal


def _moved(
    record: LateralRecord, problem: LateralProblem, t: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the inputs at the stamps, just after them, and their rates, each (E, 2)."""
    at, after, rate = (np.zeros((len(t), len(LATERAL.inputs))) for _ in range(3))
    for j, name in enumerate(LATERAL.inputs):
        if name in record.inputs:
            command = record.inputs[name]
            here, begun, arrival = problem.servo(name).move(command.t, command.y, t)
            at[:, j], after[:, j] = here, begun
            rate[:, j] = padded((arrival - begun[:-1]) / np.diff(t))
    return at, after, rate


def _changed(
    record: LateralRecord, problem: LateralProblem, t: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the derivatives by ``CAUSES`` of the inputs at the stamps, just after them, and of their rates,
    each (E, 3, 2)."""
    at, after, rate = (np.zeros((len(t), len(CAUSES), len(LATERAL.inputs))) for _ in range(3))
    for j, name in enumerate(LATERAL.inputs):
        if name in record.inputs:
            change = problem.servo(name).changes(*record.inputs[name], t)
            causes = [CAUSES.index("command"), CAUSES.index(name)]
            at[:, causes, j], after[:, causes, j], rate[:, causes, j] = change.at, change.start, change.slope
    return at, after, rate


def _known(
    record: LateralRecord, middle: FloatArray, speed: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return the known matrix (E, 4, 4), and the factors (E, 4) of sin φ and of r·cos φ."""
    alpha, theta, q = (padded(s.at(middle)) for s in (record.alpha, record.theta, record.q))
    linear = np.zeros((len(speed), 4, 4))
    linear[:, _BETA, _P], linear[:, _BETA, _R] = np.sin(alpha), -np.cos(alpha)
    linear[:, _BANK, _P] = 1.0
    sine, turn = np.zeros((len(speed), 4)), np.zeros((len(speed), 4))
    sine[:, _BETA] = GRAVITY_M_S2 / speed * np.cos(theta)
    sine[:, _BANK] = q * np.tan(theta)
    turn[:, _BANK] = np.tan(theta)
    return linear, sine, turn


def _outputs(speed: FloatArray, problem: LateralProblem) -> tuple[FloatArray, FloatArray]:
    """Return the factors (E, outputs, 4) of the states, and of the parameters' part of the rates."""
    seen = np.zeros((len(speed), len(LATERAL.outputs), 4))
    felt = np.zeros_like(seen)
    for name, state in (("p", _P), ("r", _R), ("bank", _BANK), ("beta", _BETA)):
        seen[:, LATERAL.outputs.index(name), state] = 1.0
    seen[:, LATERAL.outputs.index("beta"), _R] = problem.beta_arm_m / speed
    force = LATERAL.outputs.index("a_y")
    felt[:, force, _BETA] = speed
    felt[:, force, _R] = problem.accelerometer_arm_m
    return seen, felt
