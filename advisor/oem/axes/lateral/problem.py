"""Estimation problem of the lateral axis: data of one or more manoeuvres, each channel at its stamps."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from advisor.aircraft.added_term import OF_SIDE, parse_term
from advisor.aircraft.standard_gravity import GRAVITY_M_S2
from advisor.model.axes.lateral import CONTROLS, LATERAL
from advisor.model.axis_response import AxisGrid
from advisor.model.response import Index
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

_BETA, _P, _R, _BANK = range(len(LATERAL.states))
LEAST_PART = 0.2
"""Least range of an input, over the larger input's range, for a test of the input. A rudder of 0.9 deg in an
aileron test of 12 deg only responds to the motion. Derivatives of a rudder that follows the motion would be
wrong by half."""
NEEDED = ("p", "r", "bank")
"""Outputs that every record has."""
CAUSES = ("command", *LATERAL.inputs)
"""Causes of changed inputs: the delay of all commands, and the lag of each servo."""
SPEED = 7
"""Index of the air speed among the known factors."""
OPEN = ("airspeed_excess", "alpha_excess_rad")
"""Open numbers: the logarithm of the true over the read air speed, and the excess of the angle of attack.
Their columns stand after the parameters' columns."""
ALL = len(LATERAL.names.shared) + len(LATERAL.names.local)
"""Number of parameters of a manoeuvre."""
_AIR, _ALPHA = range(ALL, ALL + len(OPEN))
_SINE = len(LATERAL.states) + len(LATERAL.inputs) + 1
TURNING = np.array(
    [
        (_BETA, _P, 1, -1, 1), (_BETA, _R, 2, -1, 1), (_BETA, _SINE, 3, -1, 1), (_BANK, _P, 0, -1, 1),
        (_BANK, _SINE, 4, -1, 1), (_BANK, _SINE + 1, 5, -1, 1),
        (_BETA, _SINE, 3, _AIR, -1), (_BETA, _P, 2, _ALPHA, -1), (_BETA, _R, 1, _ALPHA, 1),
    ]
)  # fmt: skip
"""Known terms of the rates, for ``AxisGrid``, by the factors 1, sin α, -cos α, (g/V)·cos θ, q·tan θ, tan θ,
x_β/V, V and x_a."""
_RATE = len(LATERAL.states)
SEEN = np.array(
    [
        (LATERAL.outputs.index(output), state, factor, number, sign)
        for output, state, factor, number, sign in (
            ("p", _P, 0, -1, 1), ("r", _R, 0, -1, 1), ("bank", _BANK, 0, -1, 1), ("beta", _BETA, 0, -1, 1),
            ("beta", _R, 6, -1, 1), ("a_y", _RATE + _BETA, SPEED, -1, 1), ("a_y", _RATE + _R, 8, -1, 1),
            ("beta", _R, 6, _AIR, -1), ("a_y", _RATE + _BETA, SPEED, _AIR, 1),
        )
    ]
)  # fmt: skip
"""Terms of the outputs, for ``AxisGrid``."""
_INITIAL = tuple(range(len(LATERAL.place), len(LATERAL.place) + len(LATERAL.states)))


@dataclass(frozen=True, slots=True)
class LateralRecord:
    """Data of one lateral manoeuvre, in SI units."""

    inputs: Mapping[str, Signal]
    """Commands of aileron and rudder, rad; an unrecorded input is taken as constant."""
    outputs: Mapping[str, Signal]
    """Measured outputs by name, which always include p, r and bank."""
    airspeed: Signal
    """True air speed, m/s."""
    alpha: Signal
    """Angle of attack, rad."""
    theta: Signal
    """Pitch angle, rad."""
    q: Signal
    """Pitch rate, rad/s."""
    signals: Mapping[str, Signal] = field(default_factory=dict)
    """Further signals that added terms need, by their names in expressions."""
    before: Mapping[str, Signal] = field(default_factory=dict)
    """Commands before the record, which still move the servos at its begin."""

    def command(self, name: str) -> Signal:
        """Return the command of an input, rad, with its samples before the record."""
        return self.inputs[name].after(self.before.get(name))


@dataclass(frozen=True, slots=True)
class LateralProblem:
    """Records that share the lateral derivatives, and the properties of their instruments."""

    records: tuple[LateralRecord, ...]
    reference_airspeed_m_s: float | None = None
    """Air speed of the derivatives, m/s; None if the derivatives do not scale with speed."""
    servos: Mapping[str, Servo] = field(default_factory=dict)
    """Servo of each input by name; a missing servo has neither lag nor delay."""
    command_delay_s: float = 0.0
    """Delay of all commands behind their stamps, in addition to the servo delays, s."""
    delays_s: Mapping[str, float] = field(default_factory=dict)
    """Delay of each output relative to the rates, s; 0 for a missing output."""
    beta_arm_m: float = 0.0
    """Distance of the sideslip vane ahead of the centre of gravity, m."""
    accelerometer_arm_m: float = 0.0
    """Distance of the accelerometer ahead of the centre of gravity, m."""
    airspeed_excess: float = 0.0
    """Relative excess of the true over the read air speed."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Derivatives held at a value, by name."""
    terms: Mapping[str, float] = field(default_factory=dict)
    """Coefficient of each term that the user added, by its text."""
    means: Mapping[str, float] = field(default_factory=dict)
    """Value from which a signal counts in the terms, by the signal's name."""
    alpha_excess_rad: float = 0.0
    """Excess of the true over the read angle of attack, rad."""

    @property
    def tells_force(self) -> bool:
        """Whether any record has the lateral acceleration or the sideslip."""
        return any({"a_y", "beta"} & record.outputs.keys() for record in self.records)

    @property
    def needs_beta(self) -> bool:
        """Whether a term needs the sideslip, and a record does not have it."""
        wanted = any("beta" in parse_term(term).signals for term in self.terms)
        return wanted and any("beta" not in measured_by(record) for record in self.records)

    def servo(self, name: str) -> Servo:
        """Return the servo of an input, with the delay of all commands added."""
        stated = self.servos.get(name, Servo())
        return Servo(stated.lag_s, stated.delay_s + self.command_delay_s)

    def moves(self, name: str) -> bool:
        """Return whether an input moves in any record."""
        return self.motion(name) > 0.0

    def motion(self, name: str) -> float:
        """Return the largest range of an input over the records, rad."""
        return max((float(np.ptp(r.inputs[name].y)) for r in self.records if name in r.inputs), default=0.0)

    def flies(self, name: str) -> bool:
        """Return whether an input is a part of the test, and not a pilot's correction that holds the wings
        level.
        """
        return self.motion(name) > LEAST_PART * max(self.motion(other) for other in LATERAL.inputs)


@dataclass(frozen=True, slots=True, kw_only=True)
class LateralAssembly(Laid):
    """Lateral problem laid out for the kernel."""

    grid: AxisGrid
    begin: FloatArray
    """Shape (m,): time of the first event of each record, s, which is the time of the initial states."""


def assemble_lateral(problem: LateralProblem, causes: Sequence[str] = CAUSES) -> LateralAssembly:
    """Lay the records out at the union of their stamps, with derivatives by all ``causes``.

    Raises
    ------
    ValueError
        A record lacks p, r or bank, or has fewer than two samples of one of these outputs.
    """
    pieces = [_piece(record, problem, causes) for record in problem.records]
    measured = {name for piece in pieces for name in piece.outputs}
    laid = lay_rows(pieces, LATERAL.outputs)
    grid = AxisGrid(
        first=laid.first,
        turning=TURNING,
        seen=SEEN,
        scale=np.ones(len(LATERAL.outputs)),
        forced=laid.columns["forced"] if problem.terms else np.empty((0, len(LATERAL.states))),
        row=laid.row,
        place=LATERAL.place,
        bias=LATERAL.bias,
        initial=_INITIAL,
        bank=_BANK,
        yaw=_R,
        **{name: column for name, column in laid.columns.items() if name != "forced"},
    )
    return LateralAssembly(
        names=LATERAL.names,
        grid=grid,
        begin=np.array([piece.t[0] for piece in pieces]),
        **laid.measurements,
        free=_free(problem, measured),
    )


def _free(problem: LateralProblem, measured: set[str]) -> Index:
    """Return the indices of the parameters that the moved inputs and the measured outputs determine.

    Without a vane no output determines the sideslip's level, which the trim constants absorb.
    """
    still = [name for name in LATERAL.inputs if not problem.moves(name)]
    shared = [k for k, term in enumerate(LATERAL.shared) if term.factor not in still]
    if not problem.tells_force:
        shared = [k for k in shared if LATERAL.shared[k].name in _WITHOUT_FORCE]
    fixed = {f"{name}_bias" for name in LATERAL.biases if name not in measured}
    if "beta" not in measured:
        fixed.add("beta_initial")
    shared = [k for k in shared if LATERAL.shared[k].name not in problem.fixed]
    names = LATERAL.names
    local = [len(names.shared) + j for j, name in enumerate(names.local) if name not in fixed]
    return np.array([*shared, *local], np.int64)


_WITHOUT_FORCE = ("Y_beta", *(term.name for term in LATERAL.shared if term.state != "beta"))
"""Derivatives that are estimated without a measured side force or sideslip."""


def _piece(record: LateralRecord, problem: LateralProblem, causes: Sequence[str]) -> Piece:
    """Return one record at the union of its stamps."""
    outputs = measured_in(record.outputs, LATERAL.outputs, problem.delays_s)
    with_samples(outputs, NEEDED)
    t = events_of(outputs, [problem.servo(name).grid(command.t) for name, command in record.inputs.items()])
    step = np.diff(t)
    middle = t[:-1] + step / 2.0
    read = padded(record.airspeed.at(middle))
    reference = problem.reference_airspeed_m_s
    columns = {
        "step_s": padded(step),
        "ratio": np.ones(len(t)) if reference is None else read / reference,
        "known": _known(record, problem, t, middle, read),
        **_moved(record, problem, t, causes),
    }
    columns["forced"] = _forced(record, problem, middle, columns["inputs"])
    return Piece(t, outputs, columns)


def _forced(
    record: LateralRecord, problem: LateralProblem, middle: FloatArray, inputs: FloatArray
) -> FloatArray:
    """Return what the added terms contribute to the rates of the states, shape (E, 4)."""
    forced = np.zeros((len(inputs), len(LATERAL.states)))
    if problem.terms:
        surfaces = (inputs[:-1] + inputs[1:]).T / 2.0
        values = {name: finite(signal).at(middle) for name, signal in measured_by(record).items()}
        values |= dict(zip(CONTROLS, surfaces, strict=True))
        forced[:, [_BETA, _P, _R]] = forcing(problem.terms, OF_SIDE, problem.means, values)
    return forced


def measured_by(record: LateralRecord) -> dict[str, Signal]:
    """Return the signals of a record by their names in expressions, without the controls."""
    given = {"phi": record.outputs["bank"], "p": record.outputs["p"], "r": record.outputs["r"]}
    given |= {"alpha": record.alpha, "theta": record.theta, "q": record.q, "V": record.airspeed}
    beta = {"beta": record.outputs["beta"]} if "beta" in record.outputs else {}
    return {**given, **beta, **record.signals}


def _moved(
    record: LateralRecord, problem: LateralProblem, t: FloatArray, causes: Sequence[str]
) -> dict[str, FloatArray]:
    """Return the inputs at the stamps, just after them, and their rates, each (E, 2), with their derivatives
    by k causes, each (E, k, 2)."""
    inputs = np.zeros((3, len(t), len(LATERAL.inputs)))
    changed = np.zeros((3, len(t), len(causes), len(LATERAL.inputs)))
    for j, name in enumerate(LATERAL.inputs):
        if name in record.inputs:
            servo, command = problem.servo(name), record.command(name)
            inputs[:, :, j] = servo.course(*command, t)
            if causes:
                its = [causes.index("command"), causes.index(name)]
                changed[:, :, its, j] = servo.changes(*command, t)[:3]
    return dict(zip(("inputs", "start", "slope"), inputs, strict=True)) | dict(
        zip(("changed", "changed_start", "changed_slope"), changed, strict=True)
    )


def _known(
    record: LateralRecord, problem: LateralProblem, t: FloatArray, middle: FloatArray, read: FloatArray
) -> FloatArray:
    """Return the known factors (E, 9): of the rates on each step, of the outputs at each event."""
    alpha, theta, q = (padded(s.at(middle)) for s in (record.alpha, record.theta, record.q))
    alpha += problem.alpha_excess_rad
    true, tangent = 1.0 + problem.airspeed_excess, np.tan(theta)
    speed = true * record.airspeed.at(t)
    weight = GRAVITY_M_S2 / (true * read) * np.cos(theta)
    ones = np.ones(len(t))
    of_rates = ones, np.sin(alpha), -np.cos(alpha), weight, q * tangent, tangent
    return np.column_stack([*of_rates, problem.beta_arm_m / speed, speed, problem.accelerometer_arm_m * ones])
