"""Estimation problem of an axis: data of one or more manoeuvres, each channel at its stamps."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from advisor.aircraft.added_term import parse_term
from advisor.model.axis import Axis, Linear, Place
from advisor.model.axis_response import AxisGrid
from advisor.oem.lag import lagged
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

LEAST_PART = 0.2
"""Least range of an input, over the larger input's range, for a test of the input. A rudder of 0.9 deg in an
aileron test of 12 deg only responds to the motion. Derivatives of a rudder that follows the motion would be
wrong by half."""
COMMAND = ("command", "delay_s")
"""Place of the delay of all commands behind their stamps, in addition to the servos' delays, s."""
TERM = "term"
"""First part of the place of a term that the user added; the second part is the term's text."""


@dataclass(frozen=True, slots=True)
class AxisRecord:
    """Data of one manoeuvre along an axis, in SI units."""

    inputs: Mapping[str, Signal]
    """Commands of the inputs, rad; an unrecorded input is taken as constant."""
    outputs: Mapping[str, Signal]
    """Measured outputs by name, which always include those that the axis needs."""
    given: Mapping[str, Signal]
    """Known signals that the table of the axis names: ``airspeed``, and for example ``alpha``."""
    signals: Mapping[str, Signal] = field(default_factory=dict)
    """Further signals that added terms need, by their names in expressions."""
    before: Mapping[str, Signal] = field(default_factory=dict)
    """Commands before the record, which still move the servos at its begin."""

    def command(self, name: str) -> Signal:
        """Return the command of an input, rad, with its samples before the record."""
        return self.inputs[name].after(self.before.get(name))

    @property
    def airspeed(self) -> Signal:
        """Read air speed, m/s."""
        return self.given["airspeed"]


@dataclass(frozen=True, slots=True)
class AxisProblem:
    """Records that share the derivatives of an axis, and the properties of their instruments."""

    axis: Axis
    records: tuple[AxisRecord, ...]
    reference_airspeed_m_s: float | None = None
    """Air speed of the derivatives, m/s; None if the derivatives do not scale with speed."""
    values: Mapping[Place, float] = field(default_factory=dict)
    """Lags and delays of servos, delays of outputs relative to the rates, arms of sensors, excesses of true
    over read signals, and coefficients of terms, by their place. A missing value is zero."""
    fixed: Mapping[str, float] = field(default_factory=dict)
    """Derivatives held at a value, by name."""
    means: Mapping[str, float] = field(default_factory=dict)
    """Value from which a signal counts in the terms, by the signal's name."""
    floor: Mapping[str, float] = field(default_factory=dict)
    """Least standard deviation of outputs that were filtered before storage, where above the axis' own."""
    is_computed: bool = False
    """Whether the autopilot computes the measured hidden state from its own rates and forces, so that the
    state does not see gusts."""

    def at(self, place: Place) -> float:
        """Return the value at a place; zero, which is an ideal instrument, for a missing one."""
        return self.values.get(place, 0.0)

    def having(self, place: Place, value: float) -> "AxisProblem":
        """Return the problem with another value at a place."""
        return replace(self, values={**self.values, place: value})

    @property
    def terms(self) -> dict[str, float]:
        """Coefficient of each term that the user added, by its text."""
        return {text: value for (of, text), value in self.values.items() if of == TERM}

    @property
    def moments(self) -> dict[Place, float]:
        """Factors of the known signals that drive the rates, by their place, without zeros."""
        return {place: value for place in self.axis.moments if (value := self.at(place)) != 0.0}

    @property
    def least(self) -> FloatArray:
        """Least standard deviation of each output, shape (outputs,), SI."""
        return np.maximum(self.axis.least, [self.floor.get(name, 0.0) for name in self.axis.outputs])

    @property
    def tells_force(self) -> bool:
        """Whether any record has the specific force or the hidden state."""
        axis = self.axis
        return any({axis.force, axis.hidden} & record.outputs.keys() for record in self.records)

    @property
    def needs_hidden(self) -> bool:
        """Whether a term needs the hidden state, and a record does not have it."""
        hidden = self.axis.hidden
        wanted = any(hidden in parse_term(term).signals for term in self.terms)
        return wanted and any(hidden not in self.spoken(record) for record in self.records)

    def spoken(self, record: AxisRecord) -> dict[str, Signal]:
        """Return the signals of a record by their names in expressions, without the controls."""
        spoken = self.axis.spoken.items()
        given = {name: record.outputs[output] for name, output in spoken if output in record.outputs}
        context = {"V" if name == "airspeed" else name: signal for name, signal in record.given.items()}
        return {**given, **context, **record.signals}

    def servo(self, name: str) -> Servo:
        """Return the servo of an input, with the delay of all commands added."""
        return Servo(self.at((name, "lag_s")), self.at((name, "delay_s")) + self.at(COMMAND))

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
        return self.motion(name) > LEAST_PART * max(self.motion(other) for other in self.axis.inputs)

    @property
    def mean_airspeed_m_s(self) -> float:
        """Mean of the records' mean air speeds, m/s."""
        return float(np.mean([np.mean(record.airspeed.y) for record in self.records]))

    def trim(self, m: int) -> dict[str | Place, float]:
        """Return the mean of each known signal of record ``m``, and the values of the instruments."""
        means = {name: float(np.mean(signal.y)) for name, signal in self.records[m].given.items()}
        values: dict[str | Place, float] = {place: self.at(place) for place in self.axis.instruments}
        values.update(means)
        return values | {"q": 0.0}

    def linear(self, theta: FloatArray, m: int, true: bool = True) -> Linear:
        """Return the linear motion of record ``m`` about its trim, with derivatives ``theta`` (s,).

        ``true`` corrects the read air speed by its excess.
        """
        trim = self.trim(m)
        speed = trim["airspeed"]
        ratio = speed / (self.reference_airspeed_m_s or speed)
        if true:
            trim["airspeed"] = (1.0 + self.at(("airspeed", "excess"))) * speed
        scaled = theta * np.array([ratio**term.power for term in self.axis.shared])
        return self.axis.linear(scaled, trim)


class Surroundings(dict[str | Place, FloatArray | float]):
    """Known signals of a record at some times, corrected by the errors that the problem states."""

    def __init__(self, problem: AxisProblem, record: AxisRecord, t: FloatArray, steps: bool = False) -> None:
        super().__init__({place: problem.at(place) for place in problem.axis.instruments})
        self._problem, self._record, self._t, self._steps = problem, record, t, steps

    def __missing__(self, name: str) -> FloatArray:
        read = self._record.given[name].at(self._t)
        read = padded(read) if self._steps else read
        excess = self._problem.at(("airspeed", "excess"))
        value = (1.0 + excess) * read if name == "airspeed" else read + self._problem.at((name, "excess_rad"))
        self[name] = value
        return np.asarray(value)


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisAssembly(Laid):
    """Problem of an axis laid out for the kernel."""

    axis: Axis
    grid: AxisGrid
    begin: FloatArray
    """Shape (m,): time of the first event of each record, s, which is the time of the initial states."""
    least: FloatArray
    """Shape (outputs,): least standard deviation of each output's noise, SI."""
    causes: tuple[Place, ...] = ()
    """Places by which the derivatives of the inputs are laid out."""


def causes_of(axis: Axis) -> tuple[Place, ...]:
    """Return the delay of all commands, and the lag of each servo."""
    return (COMMAND, *((name, "lag_s") for name in axis.inputs))


def lay_out(problem: AxisProblem, causes: Sequence[Place] = ()) -> AxisAssembly:
    """Lay the records out at the union of their stamps, with derivatives of the inputs by all ``causes``.

    Raises
    ------
    ValueError
        A record lacks a needed output, or has fewer than two samples of it.
    """
    axis = problem.axis
    pieces = [_piece(record, problem, causes) for record in problem.records]
    measured = {name for piece in pieces for name in piece.outputs}
    laid = lay_rows(pieces, axis.outputs)
    grid = AxisGrid(
        first=laid.first,
        turning=axis.turning_rows,
        seen=axis.seen_rows,
        scale=np.array([1.0 + problem.at((name, "scale")) for name in axis.outputs]),
        factor=np.empty((0, len(axis.place))),
        forced=laid.columns["forced"]
        if problem.terms or problem.moments
        else np.empty((0, len(axis.states))),
        row=laid.row,
        place=axis.place,
        bias=axis.bias,
        initial=axis.initial,
        bank=axis.states.index(axis.bank) if axis.bank else -1,
        yaw=axis.states.index(axis.yaw) if axis.yaw else 0,
        **{name: column for name, column in laid.columns.items() if name != "forced"},
    )
    return AxisAssembly(
        axis=axis,
        names=axis.names,
        grid=grid,
        begin=np.array([piece.t[0] for piece in pieces]),
        least=problem.least,
        causes=tuple(causes),
        **laid.measurements,
        free=np.array([*_free(problem, measured)], np.int64),
    )


def _free(problem: AxisProblem, measured: set[str]) -> Iterator[int]:
    """Yield the indices of the parameters that the moved inputs and the measured outputs determine.

    Without a vane no output determines the level of the hidden state, which the trim constants absorb.
    """
    axis, names = problem.axis, problem.axis.names
    still = {name for name in axis.inputs if not problem.moves(name)}
    for k, term in enumerate(axis.shared):
        # Without a force its equation shows the damping alone.
        weak = not problem.tells_force and term.state == axis.hidden and term.factor != axis.hidden
        if term.factor not in still and not weak and term.name not in problem.fixed:
            yield k
    absorbed = {f"{name}_bias" for name in axis.biases if name not in measured}
    if axis.hidden and axis.hidden not in measured:
        absorbed.add(f"{axis.hidden}_initial")
    yield from (len(names.shared) + j for j, name in enumerate(names.local) if name not in absorbed)


def _piece(record: AxisRecord, problem: AxisProblem, causes: Sequence[Place]) -> Piece:
    """Return one record at the union of its stamps."""
    axis = problem.axis
    delays = {name: problem.at((name, "delay_s")) for name in axis.outputs}
    outputs = measured_in(record.outputs, axis.outputs, delays)
    with_samples(outputs, axis.needed)
    t = events_of(outputs, [problem.servo(name).grid(command.t) for name, command in record.inputs.items()])
    step = np.diff(t)
    middle = t[:-1] + step / 2.0
    read, reference = padded(record.airspeed.at(middle)), problem.reference_airspeed_m_s
    columns = {
        "step_s": padded(step),
        "ratio": np.ones(len(t)) if reference is None else read / reference,
        "known": _known(record, problem, t, middle),
        **_moved(record, problem, t, causes),
    }
    columns["forced"] = forced(record, problem, middle, columns["inputs"])
    return Piece(t, outputs, columns)


def _known(record: AxisRecord, problem: AxisProblem, t: FloatArray, middle: FloatArray) -> FloatArray:
    """Return the known factors (E, f): of the rates on each step, of the outputs at each event."""
    axis = problem.axis
    on_steps, at_events = (
        Surroundings(problem, record, times, steps) for times, steps in ((middle, True), (t, False))
    )
    columns: list[FloatArray | float] = [1.0]
    columns += [
        factor(at_events if name in axis.of_outputs else on_steps) for name, factor in axis.factors.items()
    ]
    return np.column_stack([np.broadcast_to(column, t.shape) for column in columns])


def forced(record: AxisRecord, problem: AxisProblem, middle: FloatArray, inputs: FloatArray) -> FloatArray:
    """Return what added terms and known moments contribute to the rates of the states, shape (E, n)."""
    axis = problem.axis
    rates = np.zeros((len(inputs), len(axis.states)))
    for place, value in problem.moments.items():
        moment, lag = axis.moments[place], problem.at((place[0], "lag_s"))
        if all(name in record.signals for name in moment.signals):
            driving = [_behind(record.signals[name], lag).at(middle) for name in moment.signals]
            rates[:, axis.states.index(moment.state)] += padded(value * np.prod(driving, axis=0))
    if problem.terms:
        surfaces = (inputs[:-1] + inputs[1:]).T / 2.0
        values = {name: finite(signal).at(middle) for name, signal in problem.spoken(record).items()}
        values |= dict(zip(axis.controls, surfaces, strict=True))
        rows = [axis.states.index(state) for state in axis.letters.values()]
        rates[:, rows] += forcing(problem.terms, tuple(axis.letters), problem.means, values)
    return rates


def _behind(signal: Signal, lag_s: float) -> Signal:
    """Return a signal behind a first-order lag, as the thrust behind the throttle."""
    if not lag_s > 0.0:
        return signal
    return Signal(signal.t, lagged(np.diff(signal.t), signal.y[:-1], signal.y[1:], lag_s, signal.y[0]))


def _moved(
    record: AxisRecord, problem: AxisProblem, t: FloatArray, causes: Sequence[Place]
) -> dict[str, FloatArray]:
    """Return the inputs at the stamps, just after them, and their rates, each (E, u), with their derivatives
    by k causes, each (E, k, u)."""
    names = problem.axis.inputs
    inputs, changed = np.zeros((3, len(t), len(names))), np.zeros((3, len(t), len(causes), len(names)))
    for j, name in enumerate(names):
        if name in record.inputs:
            servo, command = problem.servo(name), record.command(name)
            inputs[:, :, j] = servo.course(*command, t)
            by = [COMMAND, (name, "delay_s"), (name, "lag_s")]
            if wanted := [(causes.index(place), place) for place in by if place in causes]:
                changes = servo.changes(*command, t)[:3]
                for k, place in wanted:
                    changed[:, :, k, j] = [change[:, int(place[1] == "lag_s")] for change in changes]
    return dict(zip(("inputs", "start", "slope"), inputs, strict=True)) | dict(
        zip(("changed", "changed_start", "changed_slope"), changed, strict=True)
    )
